"""A package for spack. Untested: nobody has run spack on it."""
from spack.package import *


class Dartcast(CMakePackage):
    """Continuous collision detection of particles and solids in deformable environments."""

    homepage = "https://example.org/dartcast"
    version("0.2.0")

    variant("python", default=True, description="Build the Python package")

    depends_on("cmake@3.25:", type="build")
    depends_on("boost")
    depends_on("eigen@3.4:")
    depends_on("expat")
    depends_on("fmt@9:")
    depends_on("intel-tbb")
    depends_on("lz4")
    depends_on("zlib-api")
    depends_on("nlohmann-json@3.11:")
    depends_on("tomlplusplus")
    depends_on("cli11@2.1:")
    depends_on("python@3.9:", when="+python")
    depends_on("py-pybind11", when="+python")
    depends_on("py-numpy", when="+python", type=("build", "run"))

    def cmake_args(self):
        return [
            self.define_from_variant("DARTCAST_PYTHON", "python"),
        ]
