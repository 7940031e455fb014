# One interface target carries the flags of every target of ours.
add_library(barchan_options INTERFACE)
target_compile_features(barchan_options INTERFACE cxx_std_20)
target_compile_options(barchan_options INTERFACE
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion>")  # of ours, not of who uses the library
if(BARCHAN_WERROR)
  target_compile_options(barchan_options INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
if(BARCHAN_ARCH STREQUAL "dispatch" AND NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(BARCHAN_ARCH native)
endif()
if(BARCHAN_ARCH STREQUAL "dispatch")
  # The hot files are compiled a second time with these (src/CMakeLists.txt). The tuning of Zen 3 lets loops that the
  # compiler vectorizes use whole registers; that of x86-64-v4 itself stops at half of one.
  add_library(barchan_avx512_options INTERFACE)
  target_compile_options(barchan_avx512_options INTERFACE -march=x86-64-v4 -mtune=znver3)
  target_compile_options(barchan_options INTERFACE -march=x86-64-v3)
  target_compile_definitions(barchan_options INTERFACE BARCHAN_DISPATCH)
elseif(BARCHAN_ARCH)
  target_compile_options(barchan_options INTERFACE -march=${BARCHAN_ARCH})
endif()
# Contraction is fixed by the compiler and the target alone, never by the data or the number of threads.
target_compile_options(barchan_options INTERFACE -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(barchan_options INTERFACE -Wno-psabi -Wno-restrict)  # both are false alarms of g++ 12
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # A loop that clang does not vectorize is slower, not wrong.
  target_compile_options(barchan_options INTERFACE -Wno-pass-failed)
endif()
if(BARCHAN_SANITIZE)
  target_compile_options(barchan_options INTERFACE -fsanitize=${BARCHAN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(barchan_options INTERFACE -fsanitize=${BARCHAN_SANITIZE})
  # Checks in every operation, all inlined into one loop, take g++ 12 minutes a file (models/fluid/fluid_rates.cpp: 165 s, so 51 s).
  target_compile_definitions(barchan_options INTERFACE BARCHAN_SIMD_INLINE=inline)
endif()

# Two thirds of the compiler's time of most files go into the headers that they include, so the frequent ones are read once for a
# target. A file still includes what it uses: preset dev reads every header in every file.
set(BARCHAN_FREQUENT_HEADERS
  <algorithm> <array> <atomic> <bit> <charconv> <chrono> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <fstream> <functional> <limits>
  <map> <memory> <numbers> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <tuple> <type_traits> <unordered_map> <utility>
  <variant> <vector>)
foreach(header base/errors base/vec3 base/aligned simd/vec kernels/kernel state/particles scene/couplings models/workspace)
  list(APPEND BARCHAN_FREQUENT_HEADERS ${PROJECT_SOURCE_DIR}/src/${header}.hpp)
endforeach()
function(barchan_read_headers_once target)
  target_precompile_headers(${target} PRIVATE ${BARCHAN_FREQUENT_HEADERS} ${ARGN})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # g++ 12 forgets that <string> is a system header and warns of "a" + string. Preset dev keeps these warnings.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
    if(NOT BARCHAN_ARCH STREQUAL "dispatch")  # and of its own intrinsics for AVX-512
      target_compile_options(${target} PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
    endif()
  endif()
endfunction()

# Compiles the sources of a target together, at most six files of a folder in one batch; a file that is named by no call stays
# alone. Names in namespaces without a name must differ within a folder then. Preset dev compiles each file alone:
# a file includes what it uses.
function(barchan_compile_together target)
  if(NOT BARCHAN_TOGETHER)
    return()
  endif()
  set(most 6)
  set(folder "")
  foreach(source ${ARGN})
    get_filename_component(here ${source} DIRECTORY)
    if(NOT here STREQUAL folder)
      set(folder ${here})
      set(files 0)
      file(RELATIVE_PATH name ${CMAKE_CURRENT_SOURCE_DIR} ${folder})
      string(REPLACE "/" "_" name "${name}")
    endif()
    math(EXPR batch "${files} / ${most}")
    math(EXPR files "${files} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${name}_${batch}")
  endforeach()
  # A local name may be a global one of another file of the batch: the presets that compile each file alone look for shadows.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP
    UNITY_BUILD_CODE_BEFORE_INCLUDE "#pragma GCC diagnostic ignored \"-Wshadow\"")
endfunction()
