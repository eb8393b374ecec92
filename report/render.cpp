// SPDX-License-Identifier: Apache-2.0
#include <report/render.h>

#include <report/camera.h>
#include <report/colour.h>
#include <report/denoise.h>

#include <embree3/rtcore.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace raycontact::report {
namespace {

const Float3 sun_direction = unit({-0.62f, -0.38f, 0.84f});
constexpr Float3 sun_light{3.0f, 2.75f, 2.35f}; // linear, warm against the blue of the sky
constexpr float sun_radius = 0.05f;             // of its disc at distance 1: the softness of the shadows
constexpr Float3 ground_albedo{0.50f, 0.50f, 0.49f};
constexpr Float3 backdrop{0.80f, 0.85f, 0.93f};

struct Point2 {
    float x = 0, y = 0;
};

/// A point of the R2 sequence (Roberts 2018), turned by a hash of the pixel.
class Sampler {
public:
    explicit Sampler(std::uint32_t pixel, std::uint32_t stream)
        : turn_x_(hash(pixel * 4 + stream)), turn_y_(hash(turn_x_ ^ 0x9e3779b9u)) {}
    Point2 operator()(std::uint32_t k) const {
        return {fraction(turn_x_ + k * 3242174889u), fraction(turn_y_ + k * 2447445414u)};
    }

private:
    static std::uint32_t hash(std::uint32_t v) { // PCG's output permutation
        v = v * 747796405u + 2891336453u;
        v = ((v >> ((v >> 28) + 4)) ^ v) * 277803737u;
        return (v >> 22) ^ v;
    }
    static float fraction(std::uint32_t v) { return static_cast<float>(v >> 8) / 16777216.0f; }
    std::uint32_t turn_x_, turn_y_;
};

/// Uniform in the unit disc.
Point2 in_disc(Point2 u) {
    const float radius = std::sqrt(u.x), angle = 2 * std::numbers::pi_v<float> * u.y;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Two directions that make a right-handed frame with a unit normal (Duff et al. 2017).
void frame_of(Float3 n, Float3& a, Float3& b) {
    const float sign = std::copysign(1.0f, n.z), p = -1 / (sign + n.z), q = n.x * n.y * p;
    a = {1 + sign * n.x * n.x * p, sign * q, -sign * n.x};
    b = {q, sign + n.y * n.y * p, -n.y};
}

struct Hit {
    float distance = std::numeric_limits<float>::infinity();
    Float3 normal, albedo;
    bool ground = false;
};

/// Everything one picture needs, shared by its rows.
struct View {
    RTCScene scene = nullptr;
    Stage stage;
    Camera camera;
    std::vector<Float3> colours; ///< per body
    std::vector<Pose> poses;     ///< per body
    float reach = 1;             ///< radius about the pile within which the ground is drawn in full, metres
    Point2 middle;               ///< of the pile
    bool coarse = false;         ///< one sample a pixel, also at edges
    float pixel = 0;             ///< width at distance 1
};

RTCRayHit ray_from(Float3 origin, Float3 direction, float near) {
    RTCRayHit ray{};
    ray.ray = {origin.x,    origin.y,    origin.z,
               near,        direction.x, direction.y,
               direction.z, 0,           std::numeric_limits<float>::infinity(),
               ~0u,         0,           0};
    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return ray;
}

/// A normal, from the body's to the picture's frame.
Float3 turned(const Pose& pose, Float3 n) {
    const auto& r = pose.rotation;
    const auto part = [&](std::size_t i) {
        return static_cast<float>(r[3 * i] * n.x + r[3 * i + 1] * n.y + r[3 * i + 2] * n.z);
    };
    return unit({part(0), part(1), part(2)});
}

bool occluded(const View& view, Float3 origin, Float3 direction) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray = ray_from(origin, direction, 0).ray;
    rtcOccluded1(view.scene, &context, &ray);
    return ray.tfar < 0;
}

/// The ground's grid: a line every metre, a stronger one every five, as wide as a pixel at least.
float grid(Float3 p, float footprint) {
    const auto line = [&](float coordinate, float spacing, float half_width) {
        const float away = std::fabs(coordinate - spacing * std::floor(coordinate / spacing + 0.5f));
        const float blur = std::max(footprint, 1e-4f);
        const float cover = std::clamp((half_width - away) / blur + 0.5f, 0.0f, 1.0f);
        return cover * std::min(1.0f, 2 * half_width / blur);
    };
    const float fine = std::max(line(p.x, 1, 0.012f), line(p.y, 1, 0.012f));
    const float coarse = std::max(line(p.x, 5, 0.022f), line(p.y, 5, 0.022f));
    return std::max(0.22f * fine, 0.38f * coarse);
}

Hit cast(const View& view, Float3 direction) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit ray = ray_from(view.camera.eye, direction, 0.01f);
    rtcIntersect1(view.scene, &context, &ray);
    Hit hit;
    if (view.stage.ground && direction.z < 0) {
        hit.distance = (view.stage.ground->height - view.camera.eye.z) / direction.z;
        if (!view.stage.ground->holds(view.camera.eye + hit.distance * direction)) hit.distance = Hit().distance;
    }
    if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID && ray.ray.tfar < hit.distance) {
        const std::uint32_t body = ray.hit.instID[0];
        hit.distance = ray.ray.tfar;
        hit.albedo = view.colours[body];
        hit.normal = turned(view.poses[body], {ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z});
        if (dot(hit.normal, direction) > 0) hit.normal = -1.0f * hit.normal;
    } else if (std::isfinite(hit.distance)) {
        const Float3 p = view.camera.eye + hit.distance * direction;
        const float footprint = view.pixel * hit.distance / std::sqrt(std::max(0.05f, -direction.z));
        hit.ground = true;
        hit.normal = {0, 0, 1};
        hit.albedo = (1 - grid(p, footprint)) * ground_albedo;
    }
    return hit;
}

struct Shade {
    Float3 albedo, light, extra, normal, position;
};

Shade shade(const View& view, Float3 direction, std::uint32_t pixel, std::uint32_t sample) {
    // The light of further samples is smoothed with the first's: they are there for the colours.
    const std::uint32_t ambient_rays = sample == 0 ? 3 : 1;
    const Hit hit = cast(view, direction);
    Shade result;
    if (!std::isfinite(hit.distance)) {
        result.extra = backdrop;
        return result;
    }
    const Float3 p = view.camera.eye + hit.distance * direction, n = hit.normal;
    const Float3 origin = p + (1e-4f * (1 + hit.distance)) * n;

    Float3 a, b;
    frame_of(sun_direction, a, b);
    const Point2 on_sun = in_disc(Sampler(pixel, 0)(sample));
    const Float3 to_sun = unit(sun_direction + (sun_radius * on_sun.x) * a + (sun_radius * on_sun.y) * b);
    const float facing = dot(n, to_sun);
    const bool lit = facing > 0 && !occluded(view, origin, to_sun);
    Float3 light;
    if (lit) light = facing * sun_light;

    frame_of(n, a, b);
    const Sampler ambient(pixel, 1);
    for (std::uint32_t k = 0; k < ambient_rays; ++k) {
        const Point2 u = in_disc(ambient(2 * std::min(sample, 1u) + sample + k)); // cosine-weighted
        const Float3 d = u.x * a + u.y * b + std::sqrt(std::max(0.0f, 1 - u.x * u.x - u.y * u.y)) * n;
        const Float3 open = sky(d);
        // A ray that meets a body brings what that body, of about this colour, reflects: light after the first bounce.
        const Float3 seen = occluded(view, origin, d) ? 0.38f * (hit.albedo * open) : open;
        light += (1.0f / float(ambient_rays)) * seen;
    }

    Float3 extra;
    if (!hit.ground) {
        const Float3 half = unit(to_sun - direction);
        const float gloss = std::pow(std::max(0.0f, dot(n, half)), 48.0f);
        const float rim = std::pow(1 + std::min(0.0f, dot(n, direction)), 5.0f);
        if (lit) extra += (0.22f * gloss) * sun_light;
        extra += (0.10f * rim) * (light * sky({0, 0, 0.3f}));
    }
    result = {hit.albedo, light, extra, n, p};
    if (hit.ground) {
        const float x = p.x - view.middle.x, y = p.y - view.middle.y;
        const float t = std::clamp((std::sqrt(x * x + y * y) / view.reach - 1.1f) / 2.2f, 0.0f, 1.0f);
        const float fade = t * t * (3 - 2 * t);
        result.albedo = (1 - fade) * result.albedo;
        result.extra = fade * backdrop;
    }
    return result;
}

/// The sum of a pixel's samples, and how many there are and of these met something.
struct Pixel {
    Shade sum;
    std::uint32_t samples = 0, hits = 0;
};

void add_sample(const View& view, std::uint32_t x, std::uint32_t y, const Layers& size, Pixel& pixel) {
    constexpr std::uint32_t side = 2; // of the square of samples
    const std::uint32_t here = y * size.width + x, k = pixel.samples++;
    const Point2 jitter = Sampler(here, 2)(k);
    const std::uint32_t column = k % side, row = k / side;
    const float u = static_cast<float>(x) + (static_cast<float>(column) + jitter.x) / float(side);
    const float v = static_cast<float>(y) + (static_cast<float>(row) + jitter.y) / float(side);
    const Float3 direction =
        view.camera.direction(u / static_cast<float>(size.width), v / static_cast<float>(size.height));
    const Shade s = shade(view, direction, here, k);
    pixel.sum.albedo += s.albedo;
    pixel.sum.light += s.light;
    pixel.sum.extra += s.extra;
    pixel.sum.normal += s.normal;
    pixel.sum.position += s.position;
    pixel.hits += dot(s.normal, s.normal) > 0;
}

void put(const Pixel& pixel, std::size_t here, Layers& layers) {
    const float share = 1.0f / float(pixel.samples);
    layers.albedo[here] = share * pixel.sum.albedo;
    layers.extra[here] = share * pixel.sum.extra;
    if (pixel.hits == 0) return;
    layers.light[here] = (1 / float(pixel.hits)) * pixel.sum.light;
    layers.normal[here] = unit(pixel.sum.normal);
    layers.position[here] = (1 / float(pixel.hits)) * pixel.sum.position;
}

/// Whether one sample is too few: another face, another body or the backdrop is beside this pixel.
bool is_edge(const Layers& layers, std::uint32_t x, std::uint32_t y) {
    const std::size_t here = std::size_t{y} * layers.width + x;
    const Float3 n = layers.normal[here], colour = layers.albedo[here];
    const auto differs = [&](std::size_t there) {
        const Float3 m = layers.normal[there], d = layers.albedo[there] - colour;
        if (dot(n, n) == 0 && dot(m, m) == 0) return false;
        return dot(n, m) < 0.85f || dot(d, d) > 1e-3f;
    };
    return (x > 0 && differs(here - 1)) || (x + 1 < layers.width && differs(here + 1))
           || (y > 0 && differs(here - layers.width)) || (y + 1 < layers.height && differs(here + layers.width));
}

Image develop_layers(const Layers& layers) {
    Image image{layers.width, layers.height, std::vector<std::uint8_t>(3 * layers.light.size())};
    for (std::size_t k = 0; k < layers.light.size(); ++k)
        develop(layers.albedo[k] * layers.light[k] + layers.extra[k], image.rgb.data() + 3 * k);
    return image;
}

} // namespace

struct Renderer::State {
    explicit State(const scenes::RunLog& run) : log(run), device(rtcNewDevice(nullptr)) {
        if (!device) throw std::runtime_error("Embree does not start on this machine; no pictures");
        for (const auto& shape : log.shapes) {
            const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
            const auto vertices = shape->vertices();
            auto* out = static_cast<float*>(rtcSetNewGeometryBuffer(
                geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
            const Vec3 centre = shape->centre();
            for (const Vec3& v : vertices) {
                *out++ = static_cast<float>(v.x - centre.x);
                *out++ = static_cast<float>(v.y - centre.y);
                *out++ = static_cast<float>(v.z - centre.z);
            }
            const auto triangles = shape->triangles();
            auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
                geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
            for (const auto& t : triangles) index = std::copy(t.begin(), t.end(), index);
            rtcCommitGeometry(geometry);
            const RTCScene scene = rtcNewScene(device);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(scene);
            shapes.push_back(scene);
        }
    }
    ~State() {
        for (const RTCScene scene : shapes) rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    /// One instance a body, its id the body's; the ground is drawn without one.
    RTCScene scene_of(const scenes::Frame& frame, const Stage& stage) const {
        const RTCScene scene = rtcNewScene(device);
        for (std::size_t body = 0; body < frame.poses.size(); ++body) {
            if (stage.ground && stage.ground->body == body) continue;
            const std::uint32_t shape = log.body_shape[body];
            const Pose& pose = frame.poses[body];
            const Float3 at = place(stage, transform_point(pose, log.shapes[shape]->centre()));
            float matrix[12]; // 3 x 4, column-major
            for (std::size_t row = 0; row < 3; ++row)
                for (std::size_t column = 0; column < 3; ++column)
                    matrix[3 * column + row] = static_cast<float>(pose.rotation[3 * row + column]);
            matrix[9] = at.x, matrix[10] = at.y, matrix[11] = at.z;
            const RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(instance, shapes[shape]);
            rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
            rtcCommitGeometry(instance);
            rtcAttachGeometryByID(scene, instance, static_cast<unsigned>(body));
            rtcReleaseGeometry(instance);
        }
        rtcCommitScene(scene);
        return scene;
    }

    void look_at(const std::vector<Ball>& balls, std::uint32_t width, std::uint32_t height, View& view) const;
    Image draw(const scenes::Frame& frame, std::uint32_t width, std::uint32_t height, View& view) const;

    const scenes::RunLog& log;
    RTCDevice device;
    std::vector<RTCScene> shapes;
};

/// Camera and what goes with it.
void Renderer::State::look_at(const std::vector<Ball>& balls, std::uint32_t width, std::uint32_t height,
                              View& view) const {
    view.camera = frame_balls(balls, view.stage.ground, width, height);
    view.pixel = 2 * view.camera.half_height / static_cast<float>(height);
    for (const Ball& ball : balls) {
        view.middle.x += ball.centre.x / static_cast<float>(balls.size());
        view.middle.y += ball.centre.y / static_cast<float>(balls.size());
    }
    for (const Ball& ball : balls)
        view.reach = std::max({view.reach, std::fabs(ball.centre.x - view.middle.x) + ball.radius,
                               std::fabs(ball.centre.y - view.middle.y) + ball.radius});
}

Image Renderer::State::draw(const scenes::Frame& frame, std::uint32_t width, std::uint32_t height, View& view) const {
    view.poses = frame.poses;
    for (std::size_t body = 0; body < frame.poses.size(); ++body)
        view.colours.push_back(log.body_moves[body] ? body_colour(body) : resting_colour());
    view.scene = scene_of(frame, view.stage);

    const std::size_t pixels = std::size_t{width} * height;
    Layers layers{width,
                  height,
                  std::vector<Float3>(pixels),
                  std::vector<Float3>(pixels),
                  std::vector<Float3>(pixels),
                  std::vector<Float3>(pixels),
                  std::vector<Float3>(pixels)};
    std::vector<Pixel> first(pixels);
    const auto each = [&](auto look) {
        tbb::parallel_for(tbb::blocked_range2d<std::uint32_t>(0, height, 16, 0, width, 16), [&](const auto& tile) {
            for (std::uint32_t y = tile.rows().begin(); y < tile.rows().end(); ++y)
                for (std::uint32_t x = tile.cols().begin(); x < tile.cols().end(); ++x)
                    look(x, y, std::size_t{y} * width + x);
        });
    };
    each([&](std::uint32_t x, std::uint32_t y, std::size_t here) {
        add_sample(view, x, y, layers, first[here]);
        put(first[here], here, layers);
    });
    if (!view.coarse) {
        // Three more where colours change: faces are flat, and their light is smoothed anyway.
        std::vector<char> edges(pixels);
        each([&](std::uint32_t x, std::uint32_t y, std::size_t here) { edges[here] = is_edge(layers, x, y); });
        each([&](std::uint32_t x, std::uint32_t y, std::size_t here) {
            if (!edges[here]) return;
            while (first[here].samples < 4) add_sample(view, x, y, layers, first[here]);
            put(first[here], here, layers);
        });
    }
    rtcReleaseScene(view.scene);
    smooth_light(layers, view.camera.eye, view.pixel);
    return develop_layers(layers);
}

Renderer::Renderer(const scenes::RunLog& log) : state_(std::make_unique<State>(log)) {}
Renderer::~Renderer() = default;

Image Renderer::render(const scenes::Frame& frame, std::uint32_t width, std::uint32_t height) const {
    View view;
    view.stage = make_stage(state_->log, frame);
    state_->look_at(moving_balls(view.stage, state_->log, frame), width, height, view);
    return state_->draw(frame, width, height, view);
}

Image Renderer::render_for_film(const scenes::Frame& frame, std::uint32_t width, std::uint32_t height) const {
    const auto& frames = state_->log.frames;
    View view;
    view.stage = make_stage(state_->log, frames.back());
    view.coarse = true;
    std::vector<Ball> balls;
    for (const scenes::Frame* seen : {&frames.front(), &frames[frames.size() / 2], &frames.back()})
        for (const Ball& ball : moving_balls(view.stage, state_->log, *seen)) balls.push_back(ball);
    state_->look_at(balls, width, height, view);
    return state_->draw(frame, width, height, view);
}

} // namespace raycontact::report
