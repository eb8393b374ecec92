// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace raycontact {

/// Runs a function once for each of several numbers, all at the same time: for 0 on the caller's thread, for each other
/// one on a thread of its own, always the same. In a forked child, which has no such threads, one after another.
class SideBySide {
public:
    /// Throws std::system_error where the system gives no more threads.
    explicit SideBySide(std::size_t count);
    ~SideBySide();
    SideBySide(const SideBySide&) = delete;
    SideBySide& operator=(const SideBySide&) = delete;

    /// Begins to wake the threads, which takes a while, and does not wait for them: a run is about to come.
    void wake();
    /// Returns when all have. The function must not throw.
    void run(const std::function<void(std::size_t)>& function);

private:
    void end();
    void serve(std::size_t number);
    bool has_threads() const; ///< not in a forked child

    const std::function<void(std::size_t)>* function_ = nullptr; ///< null: the threads end
    const std::atomic<bool>* flag_ = nullptr;                    ///< of the caller's thread, which counts on each
    std::atomic<std::uint32_t> calls_{0};                        ///< of wake() and run()
    std::atomic<std::uint32_t> runs_{0};
    std::atomic<std::uint32_t> running_{0};              ///< threads
    std::uint64_t process_;                              ///< that made the threads
    std::unique_ptr<std::vector<std::jthread>> threads_; ///< last, to be joined first
};

} // namespace raycontact
