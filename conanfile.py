# SPDX-License-Identifier: Apache-2.0
"""Conan's recipe of library and recordings; scripts/conan tries it with Debian's packages."""

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import load


class RayContact(ConanFile):
    name = "raycontact"
    description = "Contacts between moving, concave triangle meshes by casting rays"
    license = "Apache-2.0"
    topics = ("collision-detection", "contact", "mesh", "simulation", "robotics")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "opencl": [True, False], "threemf": [True, False]}
    default_options = {"shared": False, "fPIC": True, "opencl": False, "threemf": False}
    implements = ["auto_shared_fpic"]
    exports_sources = "CMakeLists.txt", "LICENSE", "*.md", "cmake/*", "docs/*", "include/*", "src/*", "recording/*"
    generators = "CMakeDeps", "PkgConfigDeps"

    def set_version(self):
        lines = load(self, f"{self.recipe_folder}/CMakeLists.txt")
        self.version = lines.split("project(raycontact VERSION ")[1].split()[0]

    def requirements(self):
        self.requires("onetbb/[>=2021.8 <2023]")
        self.requires("zlib/[>=1.2.11 <2]")
        self.requires("nlohmann_json/[>=3.11 <4]", visible=False)
        self.requires("xxhash/[>=0.8.1 <1]", visible=False)  # the header alone
        if self.options.opencl:
            self.requires("opencl-icd-loader/[>=2023]")
        if self.options.threemf:
            self.requires("expat/[>=2.5 <3]")
            self.requires("minizip/[>=1.2.11 <2]")

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.25 <5]")
        if self.options.threemf:
            self.tool_requires("pkgconf/[>=1.8 <3]")

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for name, on in {
            "RECORDING": True,
            "BULLET": False,
            "PROGRAM": False,
            "TESTS": False,
            "STRICT": False,
            "OPENCL": self.options.opencl,
            "3MF": self.options.threemf,
        }.items():
            toolchain.cache_variables[f"RAYCONTACT_{name}"] = bool(on)
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        # The library's own CMake package is the one that every other way of installing it gives.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = ["lib/cmake/raycontact"]
