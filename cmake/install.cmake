# cmake --install, the Debian packages (cpack) and the CMake package Barchan. Two parts: the program with what it needs to run
# (component program), and the library with its headers (component development).
include(CMakePackageConfigHelpers)
set(data ${CMAKE_INSTALL_DATADIR}/barchan)
set(CPACK_PACKAGE_CONTACT "The Barchan developers <barchan@localhost>" CACHE STRING "maintainer of the packages: name <address>")

# ---- the program
install(TARGETS barchan RUNTIME COMPONENT program)
install(DIRECTORY scenes/ DESTINATION ${data}/scenes COMPONENT program)
install(DIRECTORY pvstate/ DESTINATION ${data}/pvstate USE_SOURCE_PERMISSIONS COMPONENT program PATTERN __pycache__ EXCLUDE)
if(EXISTS ${PROJECT_SOURCE_DIR}/python/barchan)
  install(DIRECTORY python/ DESTINATION ${data}/python COMPONENT program PATTERN __pycache__ EXCLUDE)
  # The same package where Debian's python3 looks for it, when the prefix is /usr.
  set(BARCHAN_PYTHON_DIR lib/python3/dist-packages CACHE STRING "folder below the prefix where a link to the Python package goes")
  file(RELATIVE_PATH package ${CMAKE_INSTALL_PREFIX}/${BARCHAN_PYTHON_DIR} ${CMAKE_INSTALL_PREFIX}/${data}/python/barchan)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/made)
  file(CREATE_LINK ${package} ${PROJECT_BINARY_DIR}/made/barchan SYMBOLIC)
  install(FILES ${PROJECT_BINARY_DIR}/made/barchan DESTINATION ${BARCHAN_PYTHON_DIR} COMPONENT program)
endif()
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program FILES_MATCHING PATTERN *.md PATTERN *.svg PATTERN *.png
        PATTERN *.jpg PATTERN figures.json EXCLUDE)
if(NOT CMAKE_CROSSCOMPILING)  # the same pages with their tables in them; without numpy they stay as they are
  install(CODE "execute_process(COMMAND /usr/bin/python3 ${PROJECT_SOURCE_DIR}/docs/tables.py --program $<TARGET_FILE:barchan>
    --into \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR})" COMPONENT program)
endif()
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)

# Made by the program from its own tables.
if(NOT BARCHAN_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  set(made ${PROJECT_BINARY_DIR}/made)
  file(MAKE_DIRECTORY ${made})
  add_custom_command(OUTPUT ${made}/barchan.1 ${made}/barchan.bash ${made}/_barchan ${made}/barchan.fish
    COMMAND barchan man > ${made}/barchan.1
    COMMAND barchan completion bash > ${made}/barchan.bash
    COMMAND barchan completion zsh > ${made}/_barchan
    COMMAND barchan completion fish > ${made}/barchan.fish
    DEPENDS barchan COMMENT "Manual page and completions")
  find_program(GZIP gzip REQUIRED)
  configure_file(packaging/debian/changelog.in ${made}/changelog @ONLY)
  add_custom_command(OUTPUT ${made}/barchan.1.gz ${made}/changelog.gz
    COMMAND ${GZIP} -9nc ${made}/barchan.1 > ${made}/barchan.1.gz
    COMMAND ${GZIP} -9nc ${made}/changelog > ${made}/changelog.gz
    DEPENDS ${made}/barchan.1 ${made}/changelog COMMENT "Compressed as Debian wants them")
  add_custom_target(barchan_made ALL DEPENDS ${made}/barchan.1.gz)
  install(FILES ${made}/barchan.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${made}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(FILES ${made}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libbarchan-dev COMPONENT development)
  install(FILES ${made}/barchan.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME barchan COMPONENT program)
  foreach(folder site-functions vendor-completions)  # of zsh; of Debian's packages
    install(FILES ${made}/_barchan DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder} COMPONENT program)
  endforeach()
  install(FILES ${made}/barchan.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
endif()

# ---- the library: find_package(Barchan), target Barchan::core
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/Barchan)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/barchan)
set(targets barchan_core barchan_options ${BARCHAN_PARTS})
set_target_properties(barchan_core PROPERTIES EXPORT_NAME core)
install(TARGETS ${targets} EXPORT BarchanTargets ARCHIVE COMPONENT development INCLUDES DESTINATION ${headers})
install(DIRECTORY src/ DESTINATION ${headers} COMPONENT development FILES_MATCHING PATTERN *.hpp PATTERN app EXCLUDE)
install(EXPORT BarchanTargets NAMESPACE Barchan:: DESTINATION ${config} COMPONENT development)
configure_package_config_file(cmake/BarchanConfig.cmake.in ${PROJECT_BINARY_DIR}/BarchanConfig.cmake INSTALL_DESTINATION ${config})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/BarchanConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/BarchanConfig.cmake ${PROJECT_BINARY_DIR}/BarchanConfigVersion.cmake DESTINATION ${config} COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libbarchan-dev RENAME copyright COMPONENT development)

# ---- cpack -G DEB
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME barchan)
set(CPACK_PACKAGE_VENDOR "The Barchan developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulator of wind-blown sand, multiphase flow and impact")
set(CPACK_PACKAGE_DESCRIPTION "Barchan integrates a scene with smoothed particle hydrodynamics (SPH):
wind over sand beds and dunes, flow with free surfaces, impact of
elastic and rigid bodies, and what couples them. It reads a scene file
and writes a series for ParaView.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME barchan)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "python3, python3-numpy, python3-matplotlib")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "python3-paraview, xvfb, xauth, libgl1-mesa-dri, ffmpeg, fonts-dejavu-core")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "bash-completion")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libbarchan-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "g++, cmake (>= 3.25), paraview-dev, libmuparser-dev, zlib1g-dev, libeigen3-dev, libtomlplusplus-dev")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The library of Barchan and its headers, for programs of your own.
find_package(Barchan) in CMake gives the target Barchan::core.")
include(CPack)
