// SPDX-License-Identifier: Apache-2.0
#include "bind.h"

#include <raycontact/device.h>
#include <raycontact/step_stats.h>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>

namespace nb = nanobind;

namespace raycontact::python {

void bind_stats(nb::module_& m) {
    nb::class_<DeviceInfo>(m, "DeviceInfo", "A device as `raycontact devices` lists it.")
        .def_ro("id", &DeviceInfo::id, "as Scene(devices=...) takes it")
        .def_ro("kind", &DeviceInfo::kind, "its back end: the id up to a colon")
        .def_ro("type", &DeviceInfo::type, "\"cpu\", \"gpu\" or \"other\"")
        .def_ro("bus", &DeviceInfo::bus, "address of the card; empty where none is known")
        .def_ro("name", &DeviceInfo::name, "as its driver gives it")
        .def_ro("driver", &DeviceInfo::driver, "its version")
        .def_ro("cores", &DeviceInfo::cores, "as the driver counts them")
        .def_ro("memory_bytes", &DeviceInfo::memory_bytes, "of its own; of a CPU the host's")
        .def_ro("exact", &DeviceInfo::exact, "its contacts have the bits of every other exact device's")
        .def_ro("usable", &DeviceInfo::usable, "it can be opened, as far as can be told without opening it")
        .def_ro("why_not", &DeviceInfo::why_not, "empty when usable")
        .def("__repr__",
             [](const DeviceInfo& device) { return "<DeviceInfo " + device.id + ": " + device.name + ">"; });
    m.def("list_devices", &list_devices,
          "The CPU, then every device that a driver offers, in the same order each time. Never raises for a missing "
          "driver.");

    nb::class_<DeviceWork>(m, "DeviceWork", "What a device did in one step.")
        .def_ro("device", &DeviceWork::device, "its id")
        .def_ro("pairs", &DeviceWork::pairs, "unordered pairs of bodies that were its own")
        .def_ro("launches", &DeviceWork::launches, "kernels started")
        .def_ro("reads", &DeviceWork::reads, "times the host waited for it")
        .def_ro("bytes_up", &DeviceWork::bytes_up, "copied to its memory")
        .def_ro("bytes_down", &DeviceWork::bytes_down, "copied from its memory")
        .def_ro("busy_ms", &DeviceWork::busy_ms, "in which its kernels ran")
        .def_ro("load", &DeviceWork::load, "what it had to do, in units of a pair at rest")
        .def_ro("ms", &DeviceWork::ms, "it took for that, with the host's share");

    nb::class_<StepDetails>(m, "StepDetails", "How a step found its contacts: counts of work, for who measures.")
        .def_ro("vertices", &StepDetails::vertices, "tested against bounds")
        .def_ro("rays", &StepDetails::rays, "that the method needs")
        .def_ro("rays_cast", &StepDetails::rays_cast, "traced through the mesh")
        .def_ro("side_tests", &StepDetails::side_tests, "directions cast to tell inside from outside")
        .def_ro("ray_length", &StepDetails::ray_length, "sum over the contacts that touch, metres")
        .def_ro("pairs_full", &StepDetails::pairs_full, "ordered pairs tested in full")
        .def_ro("pairs_skipped", &StepDetails::pairs_skipped, "ordered pairs of which no vertex was tested")
        .def_ro("pairs_as_standard", &StepDetails::pairs_as_standard,
                "ordered pairs that `certified` left to `standard`")
        .def_ro("walks", &StepDetails::walks, "rays followed from last step's triangle")
        .def_ro("walks_lost", &StepDetails::walks_lost, "of these, how many ended nowhere")
        .def_ro("walk_casts", &StepDetails::walk_casts, "of those, how many were cast in full instead")
        .def_ro("predictions", &StepDetails::predictions, "vertices followed without contact")
        .def_ro("pairs_moved", &StepDetails::pairs_moved, "from one device to another")
        .def_ro("bytes_moved", &StepDetails::bytes_moved, "of what was kept for them")
        .def_ro("work", &StepDetails::work, "a DeviceWork for each device");

    nb::class_<StepStats>(m, "StepStats", "What a step did.")
        .def_ro("pairs", &StepStats::pairs, "unordered pairs in the narrow phase")
        .def_ro("contacts", &StepStats::contacts, "that touch")
        .def_ro("contacts_new", &StepStats::contacts_new, "of these, those that did not touch in the last step")
        .def_ro("contacts_lost", &StepStats::contacts_lost, "that touched in the last step, and do not in this one")
        .def_ro("contacts_speculative", &StepStats::contacts_speculative, "that do not touch yet")
        .def_ro("contacts_reduced", &StepStats::contacts_reduced, "found, but left out by a limit")
        .def_ro("depth_max", &StepStats::depth_max, "of all contacts, metres")
        .def_ro("broad_ms", &StepStats::broad_ms, "our broad phase; 0 when pairs were given")
        .def_ro("narrow_ms", &StepStats::narrow_ms, "everything after the broad phase")
        .def_ro("pair_bytes", &StepStats::pair_bytes, "memory kept for the open pairs")
        .def_ro("devices_lost", &StepStats::devices_lost, "that failed in this step")
        .def_ro("warnings", &StepStats::warnings, "in plain words, as of a device that failed")
        .def_ro("details", &StepStats::details, "counts of work, for who measures")
        .def("__repr__", [](const StepStats& stats) {
            return "<StepStats: " + std::to_string(stats.pairs) + " pairs, " + std::to_string(stats.contacts)
                   + " contacts, " + std::to_string(stats.narrow_ms) + " ms>";
        });
}

} // namespace raycontact::python
