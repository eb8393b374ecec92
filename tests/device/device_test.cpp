// SPDX-License-Identifier: Apache-2.0
// What an OpenCL device promises (device.h), against the CPU device.
#include "device/same_contacts.h"
#include "device/work.h"

#include "device/opencl/device.h"
#include "device/opencl/program.h"
#include "device/scan.h"
#include "kernels_opencl.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>
#include <random>
#include <tuple>

using namespace raycontact;
using namespace raycontact::device_test;

namespace {

OpenDevice open_changed(const std::function<void(opencl::Source&)>& change, bool inexact = false) {
    return {std::make_unique<Executor>(1), opencl::open("opencl:0", inexact, change)};
}

void replace(std::string& text, std::string_view from, std::string_view to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
}

std::string refusal(const std::function<void(opencl::Source&)>& change) {
    try {
        open_changed(change);
    } catch (const InputError& error) {
        return error.what();
    }
    return "it was opened";
}

// ---- what it must refuse

TEST(probe, names_the_operation_that_differs) {
    const std::tuple<const char*, const char*, const char*> changes[] = {
        {"return sqrt(x);", "return x * rsqrt(x + 1.0e-30f);", "roots"},
        {"return fma(a, b, -p);", "return a * b - p;", "product residues"},
        {"results[n + i] = a + b;", "results[n + i] = as_float(as_uint(a + b) & 0xfffffffeu);", "sums"},
        {"results[3u * n + i] = a / b;", "results[3u * n + i] = a * (1.0f / b);", "quotients"},
        {"0.75f * denormal", "0.0f * denormal", "denormals"},
    };
    for (const auto& [from, to, operation] : changes) {
        const std::string text =
            refusal([&, from = from, to = to](opencl::Source& source) { replace(source.text, from, to); });
        EXPECT_NE(text.find(std::string(" ") + operation + " "), std::string::npos) << text;
        EXPECT_NE(text.find("opencl:0"), std::string::npos) << text;
    }
}

TEST(probe, sees_contraction_and_fast_mathematics) {
    const auto contract = [](opencl::Source& source) {
        replace(source.text, "#pragma OPENCL FP_CONTRACT OFF", "#pragma OPENCL FP_CONTRACT ON");
        source.options += " -cl-mad-enable";
    };
    EXPECT_NE(refusal(contract).find("products and sums"), std::string::npos) << refusal(contract);
    const auto fast = [](opencl::Source& source) {
        replace(source.text, "#pragma OPENCL FP_CONTRACT OFF", "");
        source.options = "-cl-std=CL1.2 -cl-fast-relaxed-math";
    };
    EXPECT_NE(refusal(fast).find("are not the host's"), std::string::npos) << refusal(fast);
    const OpenDevice opened = open_changed(contract, true);
    EXPECT_FALSE(opened.device->info().exact);
    EXPECT_NE(opened.device->info().why_not, "");
}

TEST(probe, a_device_without_exact_double_leaves_that_to_the_host) {
    const Work work = make_work(6, false);
    const auto expected = contacts_of(open_device("cpu", 1), work, every_way());
    const auto none = [](opencl::Source& source) {
        source.text = kernel_text(opencl_pieces, false);
        source.has_double = false;
    };
    const auto wrong = [](opencl::Source& source) {
        replace(source.text, "results[n + i] = a - c;", "results[n + i] = (double)(float)(a - c);");
    };
    EXPECT_TRUE(open_device("opencl:0", 1).device->traits().has_double);
    for (const std::function<void(opencl::Source&)>& change : {std::function<void(opencl::Source&)>(none), {wrong}}) {
        OpenDevice opened = open_changed(change);
        EXPECT_FALSE(opened.device->traits().has_double);
        EXPECT_TRUE(opened.device->info().exact);
        EXPECT_TRUE(same(contacts_of(std::move(opened), work, every_way()), expected));
    }
}

TEST(open, what_is_not_there_is_bad_usage) {
    const auto message = [](const char* id) -> std::string {
        try {
            open_device(id, 1);
        } catch (const InputError& error) {
            return error.what();
        }
        return "it was opened";
    };
    EXPECT_NE(message("opencl:77").find("'opencl:77': there is none; use opencl:0"), std::string::npos);
    EXPECT_NE(message("opencl:0/99").find("'opencl:0/99'"), std::string::npos);
    for (const char* id : {"opencl:", "opencl:x", "opencl:0/", "opencl:0/x", "opencl:-1", "opencl:0/0/0", "opengl:0"})
        EXPECT_NE(message(id).find(std::string("'") + id + "'"), std::string::npos) << message(id);
}

TEST(open, a_text_that_does_not_build_shows_the_log) {
    try {
        open_changed([](opencl::Source& source) { source.text += "KERNEL nonsense"; });
        FAIL();
    } catch (const InputError&) {
        FAIL() << "that is no bad usage";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("opencl:0"), std::string::npos) << error.what();
    }
}

TEST(open, lists_are_the_same_each_time) {
    const std::vector<DeviceInfo> first = list_devices(), second = list_devices();
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i].id, second[i].id);
        EXPECT_EQ(first[i].name, second[i].name);
        EXPECT_EQ(first[i].usable, first[i].why_not.empty());
        EXPECT_TRUE(first[i].type == "cpu" || first[i].type == "gpu" || first[i].type == "other");
    }
    const std::vector<DeviceInfo> opencl = opencl::describe();
    for (std::size_t i = 0; i < opencl.size(); ++i) EXPECT_EQ(opencl[i].id, "opencl:" + std::to_string(i));
    EXPECT_EQ(first.front().id, "cpu");
    EXPECT_EQ(first.back().id, opencl.back().id);
    EXPECT_EQ(open_device("opencl:0", 1).device->info().id, "opencl:0");
}

// ---- the queue

TEST(queue, write_has_read_its_source_when_it_returns) {
    const OpenDevice opened = open_device(tested_device(), 1);
    Device& device = *opened.device;
    for (const std::size_t size : {1u, 1000u, 4000000u}) {
        Array<kernels::uint> array;
        array.resize(device, 4 * size);
        std::vector<kernels::uint> source(size);
        for (kernels::uint round = 0; round < 4; ++round) {
            std::iota(source.begin(), source.end(), round);
            device.queue().write(*array.buffer(), round * size * sizeof(kernels::uint), source.data(),
                                 size * sizeof(kernels::uint));
            std::fill(source.begin(), source.end(), 0xdeadbeefu);
        }
        source = {};
        std::vector<kernels::uint> found(4 * size);
        array.read(device, found);
        for (kernels::uint round = 0; round < 4; ++round)
            for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(found[round * size + i], round + i);
    }
}

TEST(queue, reads_several_pieces_and_empty_ones) {
    const OpenDevice opened = open_device(tested_device(), 1);
    Device& device = *opened.device;
    Array<kernels::uint> array, none;
    array.write(device, std::vector<kernels::uint>{5, 6, 7, 8});
    kernels::uint last = 0;
    std::vector<kernels::uint> middle(2), nothing;
    const Piece pieces[] = {array.piece({&last, 1}, 3), none.piece(nothing), array.piece(middle, 1)};
    device.queue().read(pieces);
    EXPECT_EQ(last, 8u);
    EXPECT_EQ(middle, (std::vector<kernels::uint>{6, 7}));
    device.queue().read({});
    array.append(device, std::vector<kernels::uint>{9});
    std::vector<kernels::uint> all(5);
    array.read(device, all);
    EXPECT_EQ(all, (std::vector<kernels::uint>{5, 6, 7, 8, 9}));
}

TEST(queue, a_buffer_may_go_while_it_is_in_use) {
    const OpenDevice opened = open_device(tested_device(), 1);
    Device& device = *opened.device;
    Array<kernels::uint> kept;
    kept.resize(device, 1000000);
    for (kernels::uint round = 1; round < 20; ++round) {
        Array<kernels::uint> gone;
        gone.write(device, std::vector<kernels::uint>(1000000, round));
        device.queue().copy(*kept.buffer(), *gone.buffer(), 1000000 * sizeof(kernels::uint));
    }
    std::vector<kernels::uint> found(1000000);
    kept.read(device, found);
    EXPECT_EQ(found, std::vector<kernels::uint>(1000000, 19));
}

struct Scanned {
    std::vector<kernels::uint> firsts;
    kernels::Totals totals[2];
    kernels::uint launches = 0;
};

// The count is given, or lies where an earlier scan left it.
Scanned scan(Device& device, const std::vector<kernels::uint>& values, std::size_t columns, std::size_t count,
             std::size_t room, bool counted, kernels::uint others = 0) {
    Columns table;
    const std::size_t stride = values.size() / columns;
    table.resize(device, static_cast<kernels::uint>(columns), stride);
    if (!values.empty())
        device.queue().write(*table.values().buffer(), 0, values.data(), values.size() * sizeof(kernels::uint));
    Array<kernels::Totals> totals;
    kernels::Totals before{};
    before.items = static_cast<kernels::uint>(count);
    totals.write(device, std::vector<kernels::Totals>{before, {}});
    const Count given = counted ? items_of(totals, 0, stride) : Count(count);
    Scanned scanned;
    scanned.launches =
        device.queue().scan({given, static_cast<kernels::uint>(columns), table.stride(), table.values().buffer(),
                             table.firsts().buffer(), totals.buffer(), 1, static_cast<kernels::uint>(room), others});
    totals.read(device, scanned.totals);
    scanned.firsts.resize(count);
    table.firsts().read(device, scanned.firsts);
    return scanned;
}

TEST(scan, is_the_hosts) {
    const OpenDevice host = open_device("cpu", 1), opened = open_device(tested_device(), 1);
    std::mt19937 random(5);
    for (const std::size_t size :
         {0u, 1u, 2u, 255u, 256u, 257u, 2048u, 2049u, 5000u, 8193u, 65535u, 65536u, 65537u, 200000u, 600001u})
        for (const std::size_t columns : {1u, 2u, 4u})
            for (const bool counted : {false, true}) {
                std::vector<kernels::uint> values(size * columns);
                for (auto& value : values) value = static_cast<kernels::uint>(random() % 5);
                const std::size_t count = counted ? size - size / 3 : size;
                for (const std::size_t room : {std::size_t{0}, size, 10 * size}) {
                    const kernels::uint others = room == size ? 7 : 0;
                    const Scanned expected = scan(*host.device, values, columns, count, room, counted, others);
                    const Scanned found = scan(*opened.device, values, columns, count, room, counted, others);
                    if (count > 0) {
                        ASSERT_EQ(expected.firsts.front(), others);
                    }
                    ASSERT_EQ(found.firsts, expected.firsts) << size;
                    ASSERT_EQ(std::memcmp(found.totals, expected.totals, sizeof found.totals), 0) << size;
                    ASSERT_EQ(found.launches, expected.launches) << size;
                    ASSERT_EQ(found.launches, size > SCAN_AT_ONCE ? 3u : 1u);
                }
            }
}

TEST(scan, sums_beyond_32_bits_are_saturated) {
    const OpenDevice host = open_device("cpu", 1), opened = open_device(tested_device(), 1);
    for (const std::size_t size : {3u, 1000u, 100000u})
        for (const kernels::uint value : {0xffffffffu, 0x80000000u, 0xffffffffu / 1000u}) {
            const std::vector<kernels::uint> values(2 * size, value);
            const Scanned expected = scan(*host.device, values, 2, size, 1000, false);
            const Scanned found = scan(*opened.device, values, 2, size, 1000, false);
            EXPECT_EQ(found.firsts, expected.firsts);
            EXPECT_EQ(std::memcmp(found.totals, expected.totals, sizeof found.totals), 0) << size << " of " << value;
        }
}

// ---- what its driver compiles

std::size_t binaries() {
    const char* folder = std::getenv("POCL_CACHE_DIR");
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder ? folder : "."))
        count += entry.path().extension() == ".so";
    return count;
}

// After a device has been opened, whatever it is asked for; so none after a first step.
TEST(driver, compiles_nothing_in_a_step) {
    if (opencl::describe().at(0).driver.find("PoCL") == std::string::npos || !std::getenv("POCL_CACHE_DIR"))
        GTEST_SKIP() << "what is compiled can only be counted of PoCL, in a POCL_CACHE_DIR";
    OpenDevice opened = open_device("opencl:0", 1);
    const std::size_t before = binaries();
    EXPECT_GT(before, 20u);
    contacts_of(std::move(opened), make_work(20, true), every_way());
    contacts_of(open_device("opencl:0", 1), make_heap(20), every_way()); // scans of more than one group, too
    EXPECT_EQ(binaries(), before);
}

TEST(driver, kernels_run_for_some_time) {
    OpenDevice opened = open_device(tested_device(), 1);
    Queue& queue = opened.device->queue();
    const double before = queue.busy_ms();
    EXPECT_GT(before, 0) << "the probe";
    Array<kernels::uint> values, firsts;
    Array<kernels::Totals> totals;
    values.write(*opened.device, std::vector<kernels::uint>(4000000, 1));
    firsts.resize(*opened.device, 4000000);
    totals.resize(*opened.device, 1);
    queue.scan({4000000, 1, 4000000, values.buffer(), firsts.buffer(), totals.buffer(), 0, 10});
    queue.finish();
    EXPECT_GT(queue.busy_ms(), before);
}

} // namespace
