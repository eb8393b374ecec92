// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/side_by_side.h"
#include "part/part.h"

#include <functional>
#include <string>
#include <utility>

namespace raycontact {

/// The parts of a scene, one for each device, all with the same shapes. A part whose device fails is dropped, unless no
/// other could go on in its place: then the failure is thrown.
class Parts {
public:
    explicit Parts(std::vector<OpenDevice> opened);
    /// One more part, the last, with the shapes of the others. It and what was one part take turns, without threads of
    /// their own.
    void add(OpenDevice opened);

    /// Those dropped included: every part keeps its number.
    std::size_t size() const { return parts_.size(); }
    bool has(std::size_t number) const { return parts_[number] != nullptr; }
    std::size_t left() const;
    Part& operator[](std::size_t number) { return *parts_[number]; }
    /// The first that is left.
    std::size_t first() const;
    /// Its threads, for work on the host.
    Executor& executor() { return parts_[first()]->executor(); }
    const std::string& device(std::size_t number) const { return devices_[number]; }

    /// Calls work(number) for every part that is left, each on a thread of its own unless it was added. Returns those
    /// dropped in doing so. Throws DeviceError if all failed, and whatever else one of them threw.
    template <class Work>
    std::vector<std::size_t> run(Work&& work) {
        return run_all(std::ref(work)); // by reference: std::function would allocate
    }
    /// The same for one part, on this thread: work().
    template <class Work>
    std::vector<std::size_t> only(std::size_t number, Work&& work) {
        attempt(number, [&](std::size_t) { work(); });
        return drop_failed();
    }

    /// The same before a step, which then hears of it by take_lost(). Returns whether the part is left.
    template <class Work>
    bool before_step(std::size_t number, Work&& work) {
        const auto failed = only(number, work);
        lost_.insert(lost_.end(), failed.begin(), failed.end());
        return failed.empty();
    }

    void add_shape(const std::shared_ptr<const Shape>& shape);
    void remove_shape(const Shape* shape);
    /// As ShapeStore.
    kernels::uint index_of(const Shape* shape) const;
    bool pack_shapes();
    void accelerate_shapes();
    /// As ShapeStore: of the part that has most.
    std::size_t plain_shapes() const;

    /// Begins to wake the threads of all.
    void wake();
    void forget();

    /// Adds to take_warnings().
    void warn(std::string text) { warnings_.push_back(std::move(text)); }
    /// Whether take_lost() or take_warnings() has something to tell.
    bool has_news() const { return !lost_.empty() || !warnings_.empty(); }
    /// Those dropped by add_shape(), pack_shapes() and before_step() since the last call.
    std::vector<std::size_t> take_lost() { return std::exchange(lost_, {}); }
    /// What was dropped since the last call, and why; for the user.
    std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

private:
    using Function = std::function<void(std::size_t)>;
    std::vector<std::size_t> run_all(const Function& work);
    std::vector<std::size_t> each(const Function& work);
    void between_steps(const Function& work);
    void attempt(std::size_t number, const Function& work);
    std::vector<std::size_t> drop_failed();

    std::vector<std::unique_ptr<Part>> parts_; ///< null: dropped
    std::vector<std::string> devices_;
    std::vector<std::string> faults_; ///< of the work just done; empty: none
    std::vector<std::exception_ptr> errors_;
    std::vector<std::size_t> lost_;
    std::vector<std::string> warnings_;
    std::unique_ptr<SideBySide> threads_; ///< null for what was one part
};

} // namespace raycontact
