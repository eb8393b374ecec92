// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/holds/hold.h>
#include <tests/motion/polygon.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace raycontact::scenes {

struct Launch {
    Vec3 velocity; ///< m/s
    Vec3 spin;     ///< rad/s
};

/// The worst of several bodies, and which it was. What is not a number is worse than any, and stays.
struct Worst {
    double value = 0;
    std::size_t body = 0;
    void most(double next, std::size_t whose) {
        if (!(next <= value) && !std::isnan(value)) *this = {next, whose};
    }
};

/// Bodies that are let go at once, after a time at rest. They do not collide with each other.
class Launched : public Course {
public:
    Launched(std::vector<Launch> launches, double rest) : launches_(std::move(launches)), rest_(rest) {}
    void begin(StackWorld& world) override;
    void before_step(StackWorld& world, double dt) override;
    void after_step(const StackWorld& world, double time) override;
    /// One that does not hold where they were not let go.
    std::vector<Figure> figures() const final;

protected:
    virtual void start(const StackWorld&) {}
    virtual std::vector<Figure> measured() const = 0;
    /// After each step since. since: seconds.
    virtual void watch(const StackWorld& world, double since) = 0;

    std::vector<Launch> launches_;
    std::vector<std::size_t> movers_; ///< the bodies that move, as many as launches
    std::vector<Pose> first_;         ///< when they were let go
    double dt_ = 0;

private:
    double rest_, time_ = 0;
    bool gone_ = false;
};

/// What a slide on level ground may do, on paper nothing of it.
struct SlideBounds {
    double way = 0.01;    ///< of the way on paper, along it and beside it
    double speed = 0.01;  ///< of the speed at the start, up, and without friction slower and faster
    double height = 1e-3; ///< metres
    double turn = 1;      ///< degrees
};

/// Bodies that slide on level ground.
class Slide : public Launched {
public:
    /// braking: m/s^2 that friction takes. ground: the velocity of what is below, m/s; fixed bodies are moved with it.
    Slide(std::vector<Launch> launches, double braking, const SlideBounds& bounds, const Vec3& ground = {});
    void begin(StackWorld& world) override;
    void before_step(StackWorld& world, double dt) override;

protected:
    void start(const StackWorld& world) override;
    void watch(const StackWorld& world, double since) override;
    std::vector<Figure> measured() const override;

private:
    double braking_;
    SlideBounds bounds_;
    Vec3 ground_;
    std::vector<double> speeds_, ways_; ///< on paper, relative to the ground
    std::vector<double> along_;         ///< of the right way, at the end
    Worst beside_, slower_, faster_, up_, height_, turn_;
};

/// Bodies without friction on hills: their energy is kept.
class Coast : public Launched {
public:
    /// lowest: metres, the height of their middles where they have no energy of place. loses: part of it, at most.
    Coast(std::vector<Launch> launches, double lowest, double loses);

protected:
    void watch(const StackWorld& world, double since) override;
    std::vector<Figure> measured() const override;

private:
    double lowest_, loses_;
    std::vector<Vec3> velocity_, spin_; ///< after the step before
    std::vector<double> height_;
    std::vector<double> energy_, first_energy_;
    Worst gained_;
};

/// Bodies that run along x into a wall whose face is at x = 0.
class Halt : public Launched {
public:
    /// reach: metres from a body's middle to its front. past: metres that its middle may go farther.
    Halt(std::vector<Launch> launches, double reach, double past);

protected:
    void watch(const StackWorld& world, double since) override;
    std::vector<Figure> measured() const override;

private:
    double reach_, past_;
    Worst beyond_, speed_;
};

/// Polygons that roll along x.
class Roll : public Launched {
public:
    /// play: metres that they may go sideways.
    Roll(std::vector<Launch> launches, double radius, int sides, double play);

protected:
    void start(const StackWorld& world) override;
    void watch(const StackWorld& world, double since) override;
    std::vector<Figure> measured() const override;

private:
    Polygon wheel_;
    double play_, since_ = 0, step_ = 0; ///< metres; seconds
    std::vector<double> ways_, speeds_;
    Worst up_, beside_, faster_, lean_;
};

/// Bodies that fall on the ground, and bounce.
class Fall : public Launched {
public:
    /// drops: metres that each falls.
    Fall(std::vector<double> drops, double restitution);
    void begin(StackWorld& world) override;

protected:
    void watch(const StackWorld& world, double since) override;
    std::vector<Figure> measured() const override;

private:
    std::vector<double> drops_;
    double restitution_;
    std::vector<double> highest_;
    std::vector<int> phase_; ///< 0: falls, 1: rises, 2: has passed its top
    Worst turn_;
};

/// Bodies that go to and fro between walls along x, weightless, without loss.
class ToAndFro : public Launched {
public:
    /// room: metres from one wall to the other, less the body.
    ToAndFro(std::vector<Launch> launches, double room);
    void begin(StackWorld& world) override;

protected:
    void watch(const StackWorld& world, double since) override;
    std::vector<Figure> measured() const override;

private:
    double room_, seconds_ = 0;
    std::vector<double> speeds_, bounces_, sign_;
    Worst beside_;
};

} // namespace raycontact::scenes
