// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace raycontact::clash {

/// Calls work(i) for each i below `count` on so many threads (0: one per core), in any order, until stop() holds. The
/// first exception is thrown here.
template <class Work, class Stop>
void for_each_beside(std::size_t count, std::uint32_t threads, Work&& work, Stop&& stop) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr error;
    const auto serve = [&] {
        try {
            for (std::size_t i = next++; i < count && !stop(); i = next++) work(i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!error) error = std::current_exception();
            next = count;
        }
    };
    const std::size_t wanted = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
    {
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < std::min(wanted, count); ++i) others.emplace_back(serve);
        serve();
    }
    if (error) std::rethrow_exception(error);
}

} // namespace raycontact::clash
