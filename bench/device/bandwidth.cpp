// SPDX-License-Identifier: Apache-2.0
#include "bench/device/measure.h"

#include "device/launch.h"

#include <scenes/peers/clock.h>

#include <cstddef>
#include <vector>

namespace raycontact::bench {

using peers::median;

namespace {

constexpr std::size_t bytes = std::size_t{64} << 20;
constexpr int times = 9;
constexpr int copies = 8; // in a row: one takes a fast device hardly longer than a launch

template <class Work>
double median_seconds(Work&& work) {
    work(); // pages are made at the first touch
    std::vector<double> seconds;
    for (int i = 0; i < times; ++i) {
        const double start = peers::now().wall;
        work();
        seconds.push_back(1e-6 * (peers::now().wall - start));
    }
    return median(seconds);
}

} // namespace

Bandwidth measure_bandwidth(Device& device) {
    Queue& queue = device.queue();
    const auto one = device.make_buffer(bytes), two = device.make_buffer(bytes);
    std::vector<std::byte> host(bytes, std::byte{1});
    const Piece piece{host.data(), one.get(), 0, bytes};
    const auto nothing = [&] {
        launch<KernelId::find_ranges>(device, Count(nullptr, 0, 1), Array<kernels::Ray>{}, Array<kernels::uint>{});
    };
    constexpr double giga = 1e-9 * static_cast<double>(bytes);
    Bandwidth found;
    found.write = giga / median_seconds([&] {
                      queue.write(*one, 0, host.data(), bytes);
                      queue.finish();
                  });
    found.read = giga / median_seconds([&] { queue.read({&piece, 1}); });
    found.copy = 2 * copies * giga / median_seconds([&] {
                     for (int i = 0; i < copies; ++i) queue.copy(*two, *one, bytes);
                     queue.finish();
                 });
    found.launch_us = 1e4 * median_seconds([&] {
                          for (int i = 0; i < 100; ++i) nothing();
                          queue.finish();
                      });
    found.wait_us = 1e6 * median_seconds([&] {
                        nothing();
                        queue.finish();
                    });
    return found;
}

} // namespace raycontact::bench
