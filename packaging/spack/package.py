"""A recipe of Spack for Barchan: put this folder as packages/barchan into a repository of your own (spack repo create, spack repo add)."""
from spack.package import *


class Barchan(CMakePackage):
    """Batch simulator of wind-blown sand, multiphase flow and impact with smoothed particle hydrodynamics; writes series for ParaView."""

    # No archive is published yet: spack develop --path SOURCE barchan@0.1.0
    license("MIT")

    version("0.1.0")

    variant("native", default=False, description="compile for this machine only (-march=native)")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("vtk@9:")
    depends_on("eigen@3.4:")
    depends_on("cli11@2.1:")
    depends_on("nlohmann-json@3.11:")
    depends_on("muparser@2.3:")
    depends_on("tomlplusplus@3.3:")
    depends_on("zlib-api")
    depends_on("python@3.11:", type="run")
    depends_on("py-numpy", type="run")
    depends_on("py-matplotlib", type="run")

    requires("target=x86_64_v3:", msg="Barchan uses AVX2")
    conflicts("%gcc@:11")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define("BARCHAN_TESTS", False),
            self.define("BARCHAN_WERROR", False),
            self.define("BARCHAN_ARCH", "native" if "+native" in self.spec else "dispatch"),
        ]
