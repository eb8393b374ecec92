// SPDX-License-Identifier: Apache-2.0
// The meshes that assembly is measured with: pegs, nuts, bolts and gears of the benchmark Factory (Narang et al. 2022,
// IsaacGymEnvs). What it takes to load and prepare them, the clearance of each fit, and what becomes of it in Bullet:
// RayContact with recommend() beside GImpact with Bullet's own settings. The files are not ours: a folder holds them.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/query.h>
#include <scenes/peers/clock.h>
#include <tests/holds/depth.h>
#include <tests/holds/parts.h>
#include <tests/holds/run.h>

#include <btBulletDynamicsCommon.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::bench {

using namespace scenes;

namespace {

struct Options {
    std::filesystem::path folder;
    std::string only, finder;
    double patience = 60, seconds = 60;
    bool quick = false;
};

enum class Kind { peg, nut, gear };

/// Two files that lie in one frame, each in its place.
struct Fit {
    std::string name, moving, fixed;
    Kind kind = Kind::peg;
    double pitch = 0;  ///< of a thread, metres
    double starts = 0; ///< metres along z above its place; of a nut its thread says where
};
constexpr double plate_below = 5e-4; ///< metres, of the plate under holes, which go through

std::vector<Fit> all_fits() {
    std::vector<Fit> fits;
    for (const char* size : {"4mm", "8mm"})
        for (const char* play : {"loose", "tight"}) {
            constexpr double starts = 0.01; // 1 mm over the hole
            const auto of = [&](const char* form, const char* peg_end) {
                fits.push_back({fmt::format("{} peg {} {}", form, size, play),
                                fmt::format("{}_peg_{}_{}{}", form, size, play, peg_end),
                                fmt::format("{}_hole_{}_subdiv_3x", form, size), Kind::peg, 0, starts});
            };
            of("round", "");
            of("rectangular", "_subdiv_3x");
        }
    for (const auto& [size, pitch] : {std::pair("m8", 0.00125), std::pair("m16", 0.002)})
        for (const char* play : {"loose", "tight"})
            fits.push_back({fmt::format("nut {} {}", size, play), fmt::format("nut_{}_{}_subdiv_3x", size, play),
                            fmt::format("bolt_{}_{}", size, play), Kind::nut, pitch});
    for (const char* size : {"small", "medium", "large"}) // its post ends 20 mm above its place
        fits.push_back({fmt::format("gear {}", size), fmt::format("gear_{}_space_5e-4", size),
                        "gear_base_loose_space_5e-4_subdiv_4x", Kind::gear, 0, 0.021});
    return fits;
}

struct Part {
    Mesh mesh; ///< as it was prepared, so that all finders get the same
    std::shared_ptr<const Shape> shape;
};

/// Prints a line for each file that is there.
std::map<std::string, Part> load_parts(const Options& options, const std::vector<Fit>& fits) {
    std::set<std::string> wanted, missing;
    for (const Fit& fit : fits) wanted.insert({fit.moving, fit.fixed});
    if (options.only.empty()) wanted.insert("franka_finger_coll_subdiv_6x");
    std::map<std::string, Part> parts;
    fmt::print("{:<46} {:>8} {:>10} {:>9} {:>9}  {:<16} {}\n", "file", "load ms", "prepare ms", "in file", "triangles",
               "kind", "verdict");
    for (const std::string& name : wanted) {
        const std::filesystem::path file = options.folder / ("factory_" + name + ".obj");
        if (!std::filesystem::exists(file)) {
            missing.insert(file.filename().string());
            continue;
        }
        const double begin = peers::now().wall;
        const Mesh mesh = load_mesh(file);
        const double middle = peers::now().wall;
        PreparedMesh prepared = prepare_mesh(mesh);
        const double end = peers::now().wall;
        const MeshReport& report = prepared.report;
        fmt::print("{:<46} {:8.1f} {:10.1f} {:9} {:9}  {:<16} {}\n", name, 1e-3 * (middle - begin),
                   1e-3 * (end - middle), report.file_triangles, report.triangles, kind_of(report),
                   verdict_of(report).text);
        std::fflush(stdout);
        Part& part = parts[name];
        part.mesh = {name, prepared.vertices, prepared.triangles};
        part.shape = Shape::make(part.mesh);
    }
    for (const std::string& file : missing) fmt::print("{} is not there: what needs it is left out\n", file);
    return parts;
}

/// How the parts of a fit lie in each other, metres.
struct Room {
    double clearance = 0; ///< between them
    double starts = 0;    ///< what the moving one is lifted by when it is let go
    double seat = 0;      ///< and where its way ends: on the plate, on the base, at the run-out of the thread
};

/// A nut turns as it rises; one that only rises is in the middle of its thread once a pitch.
Room room_of(const Fit& fit, const Part& moving, const Part& fixed) {
    const auto free = [&](double lift, double turn) {
        Pose pose{.translation = {0, 0, lift}};
        pose.rotation = {std::cos(turn), -std::sin(turn), 0, std::sin(turn), std::cos(turn), 0, 0, 0, 1};
        return distance(*moving.shape, pose, *fixed.shape, Pose{})->distance;
    };
    if (fit.kind == Kind::peg) return {free(0.001, 0), fit.starts, -plate_below};
    if (fit.kind == Kind::gear) return {free(0.001, 0), fit.starts, 0};
    Room room;
    double middle = 1.5 * fit.pitch, step = fit.pitch / 80;
    for (int round = 0; round < 2; ++round, step /= 10) {
        const double around = middle;
        for (int i = round == 0 ? -40 : -10; i <= (round == 0 ? 40 : 10); ++i)
            if (const double found = free(around + i * step, 0); found > room.clearance)
                middle = around + i * step, room.clearance = found;
    }
    room.seat = middle;
    for (double down = 0; down <= middle; down += fit.pitch / 40) {
        if (free(middle - down, -2 * std::numbers::pi * down / fit.pitch) <= 0) break;
        room.seat = middle - down;
    }
    room.starts = middle + fit.pitch;
    return room;
}

/// Counts the points of contact, and knows where the moving part is, and how deep: on its way, and once it was there.
class Assembly : public Course {
public:
    Assembly(const Hold& hold, double place, double starts, double pitch)
        : probe_(hold.stack, Ground::none), sample_(hold.sample), place_(place), above_(starts), pitch_(pitch) {}
    void after_step(const StackWorld& world, double time) override {
        btDispatcher& dispatcher = *world.world().getDispatcher();
        for (int i = 0; i < dispatcher.getNumManifolds(); ++i)
            points_ += dispatcher.getManifoldByIndexInternal(i)->getNumContacts();
        const Pose pose = world.pose(moving);
        const Pose moved = relative_pose(last_.value_or(pose), pose);
        turns_ += std::atan2(moved.rotation[3], moved.rotation[0]) / (2 * std::numbers::pi);
        last_ = pose;
        above_ = pose.translation.z - place_;
        if (seated_ < 0 && above_ <= 1e-4) seated_ = time;
        double& deepest = seated_ < 0 ? on_the_way_ : there_;
        if (++steps_ % sample_ == 0) deepest = std::max(deepest, probe_.deepest(world.poses()));
    }
    std::vector<Figure> figures() const override {
        return {{.name = "above its seat", .unit = "m", .value = above_},
                {.name = "contacts a step", .unit = "", .value = points_ / std::max(steps_, 1)},
                {.name = "seated after", .unit = "s", .value = seated_},
                {.name = "turned along its thread by", .unit = "m", .value = turns_ * pitch_},
                {.name = "deepest on the way", .unit = "m", .value = on_the_way_},
                {.name = "deepest once there", .unit = "m", .value = there_}};
    }
    static constexpr std::size_t moving = 1;

private:
    DepthProbe probe_;
    int sample_, steps_ = 0;
    double place_, above_, pitch_, points_ = 0, seated_ = -1, turns_ = 0, on_the_way_ = 0, there_ = 0;
    std::optional<Pose> last_;
};

Hold scene_of(const Fit& fit, const Part& moving, const Part& fixed, const Room& room, double hertz) {
    Hold hold;
    hold.name = fit.name;
    Mesh body = moving.mesh, socket = fixed.mesh;
    const Vec3 body_centre = centre(body), socket_centre = centre(socket);
    hold.stack = {hold.name, {shape_of(std::move(socket), false), shape_of(std::move(body), false)}, {}};
    hold.stack.bodies.push_back({0, {.translation = socket_centre}, true});
    // Half the room off its axis: nothing is ever let go in the very middle.
    const double off = fit.kind == Kind::nut ? 0 : room.clearance / 2;
    hold.stack.bodies.push_back(
        {1, {.translation = {body_centre.x + off, body_centre.y, body_centre.z + room.starts}}});
    if (fit.kind == Kind::peg) {
        hold.stack.shapes.push_back(box_of({0.05, 0.05, 0.01}));
        hold.stack.bodies.push_back({2, {.translation = {0, 0, -0.005 - plate_below}}, true});
    }
    for (StackBody& part : hold.stack.bodies) {
        part.density = 7800;
        part.friction = fit.kind == Kind::nut ? 1 : 0.5;
    }
    hold.stack.bodies[Assembly::moving].friction = fit.kind == Kind::nut ? 0.01 : 0.5;
    hold.slop = std::min(1e-5, room.clearance / 5);
    hold.rest = hold.deepest = std::nullopt; // the course looks
    hold.ground = Ground::none;
    hold.hertz = hertz;
    hold.seconds = fit.kind == Kind::nut ? 1.5 : 0.5;
    hold.sample = static_cast<int>(hertz / (fit.kind == Kind::peg ? 60 : 20));
    const double place = body_centre.z + room.seat, above = room.starts - room.seat, pitch = fit.pitch;
    hold.course = [hold, place, above, pitch] { return std::make_unique<Assembly>(hold, place, above, pitch); };
    return hold;
}

/// What became of it. above, starts: metres over its seat.
std::string verdict(const Fit& fit, const Room& room, double above, double turned) {
    if (!std::isfinite(above)) return "lost";
    const double starts = room.starts - room.seat;
    // A nut may wedge itself on towards the head.
    if (above < -5e-4 - std::max(room.seat, 0.0)) return fmt::format("passes through by {:.1f} mm", -1000 * above);
    // One that falls further than it turns has jumped its thread.
    if (fit.kind == Kind::nut && std::fabs(starts - above + turned) > fit.pitch / 2) return "leaves its thread";
    if (above <= 1e-4) return "seated";
    return fmt::format("{:.2f} of {:.2f} mm", 1000 * (starts - above), 1000 * starts);
}

void run_fit(const Fit& fit, const Part& moving, const Part& fixed, const Room& room, const Options& options) {
    for (const double hertz : {60.0, 240.0, 1000.0}) {
        if (options.quick && hertz != 240) continue;
        for (const auto& [name, finder] : {std::pair("ours", Finder::edges), std::pair("gimpact", Finder::gimpact)}) {
            if (!options.finder.empty() && options.finder != name) continue;
            end_if_stopped();
            HoldOptions how;
            how.patience = options.patience;
            how.seconds = options.seconds;
            const HoldResult result = run_hold(scene_of(fit, moving, fixed, room, hertz), finder, how);
            const auto figure = [&](std::size_t i) { return result.figures[i].value; };
            const std::string became = verdict(fit, room, figure(0), figure(3));
            fmt::print("{:<26} {:>5} {:<8} {:9.1f} {:9.1f} {:9.1f} {:8.2f} {:>7}  {}{}\n", fit.name, hertz, name,
                       1e6 * figure(4), 1e6 * figure(5), figure(1), result.step_ms,
                       became == "seated" ? fmt::format("{:.3f}", figure(2)) : "-", became,
                       result.ended_early ? fmt::format(" (ended after {:.3f} s)", result.seconds) : "");
            std::fflush(stdout);
        }
    }
}

void run_all(const Options& options) {
    listen_for_stop();
    if (!std::filesystem::is_directory(options.folder)) {
        fmt::print("{} is not a folder: give the one that holds factory_*.obj, the meshes of Factory (IsaacGymEnvs)\n",
                   options.folder.string());
        return;
    }
    fmt::print("{}\n", heading(report::this_machine()));
    std::vector<Fit> fits = all_fits();
    std::erase_if(fits, [&](const Fit& fit) { return fit.name.find(options.only) == std::string::npos; });
    const std::map<std::string, Part> parts = load_parts(options, fits);
    std::erase_if(fits, [&](const Fit& fit) { return !parts.contains(fit.moving) || !parts.contains(fit.fixed); });
    fmt::print("\n{:<26} {:>12}\n", "fit", "clearance um");
    std::vector<Room> rooms;
    for (const Fit& fit : fits) {
        rooms.push_back(room_of(fit, parts.at(fit.moving), parts.at(fit.fixed)));
        fmt::print("{:<26} {:12.1f}\n", fit.name, 1e6 * rooms.back().clearance);
    }
    fmt::print("\n{:<26} {:>5} {:<8} {:>9} {:>9} {:>9} {:>8} {:>7}  {}\n", "fit", "hertz", "finder", "way um",
               "there um", "contacts", "ms/step", "seat s", "what became of it");
    until_stopped([&] {
        for (std::size_t i = 0; i < fits.size(); ++i)
            run_fit(fits[i], parts.at(fits[i].moving), parts.at(fits[i].fixed), rooms[i], options);
    });
}

} // namespace

void add_factory(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "factory", "Pegs, nuts and gears of the benchmark Factory: preparing them, their clearance, in Bullet");
    auto o = std::make_shared<Options>();
    command->add_option("FOLDER", o->folder, "that holds factory_*.obj")->required();
    add_world_options(*command, o->seconds, o->only, o->finder, "ours or gimpact");
    add_number(*command, "--patience", o->patience, "of the computer's time after which a run ends early", 0.0, 1e9)
        ->type_name("S");
    command->add_flag("--quick", o->quick, "240 steps a second alone");
    command->callback([o] { run_all(*o); });
}

} // namespace raycontact::bench
