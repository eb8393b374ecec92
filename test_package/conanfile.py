# SPDX-License-Identifier: Apache-2.0
"""The project of tests/consumer against the package, as Conan's users build theirs."""

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout


class RayContactTest(ConanFile):
    settings = "os", "arch", "compiler", "build_type"
    generators = "CMakeDeps", "PkgConfigDeps"  # the second one is for minizip, of the option threemf

    def requirements(self):
        self.requires(self.tested_reference_str)

    def layout(self):
        cmake_layout(self, src_folder="../tests/consumer/project")

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False  # it would be written beside the project's sources
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def test(self):
        if can_run(self):
            folder = self.cpp.build.bindir
            self.run(f"{folder}/consumer", env="conanrun")
            self.run(f"{folder}/clash_consumer parts.obj above.off", env="conanrun")
            self.run(f"{folder}/recording_consumer own.glb", env="conanrun")
