// SPDX-License-Identifier: Apache-2.0
#include "reference/compare.h"

#include "reference/text.h"
#include "reference/vector.h"

#include <algorithm>
#include <cstdio>
#include <map>

namespace raycontact::reference {

namespace {

struct Difference {
    double normal = 0, depth = 0, ray_length = 0, weight = 0, point = 0;
};

// One directed pair: every ray of the reference, then what the library has beyond them.
class OneWay {
public:
    OneWay(const Solid& source, const Pose& source_pose, const Solid& target, const Pose& target_pose, Side body,
           Direction direction, Comparison& sum)
        : source_(source), target_(target), source_pose_(source_pose), target_pose_(target_pose), body_(body),
          direction_(direction), sum_(sum), size_(std::max(source.diagonal, target.diagonal)) {}

    void run(std::span<const Contact> contacts) {
        std::map<std::uint32_t, const Contact*> found;
        for (const Contact& contact : contacts)
            if (contact.feature.source == body_ && contact.feature.kind == FeatureKind::vertex
                && !found.emplace(contact.feature.source_index(), &contact).second)
                complain("vertex reported twice", contact.feature.source_index(), nullptr, &contact);
        for (const CastRay& ray : cast_all(source_, source_pose_, target_, target_pose_, direction_)) {
            ++sum_.rays;
            const std::uint32_t vertex = source_.vertex_index[ray.vertex];
            const auto it = found.find(vertex);
            if (ray.contact) ++sum_.contacts;
            if (ray.contact && it == found.end()) judge("missed", ray.vertex, &ray, nullptr);
            if (!ray.contact && it != found.end()) judge("invented", ray.vertex, nullptr, it->second);
            if (ray.contact && it != found.end()) both(ray, *it->second);
            if (it != found.end()) found.erase(it);
        }
        for (const auto& [vertex, contact] : found) { // vertices the reference holds to be out of bounds
            const auto& index = source_.vertex_index;
            const auto at = std::find(index.begin(), index.end(), vertex);
            if (at == index.end())
                complain("no such vertex", vertex, nullptr, contact);
            else
                judge("out of bounds", static_cast<std::uint32_t>(at - index.begin()), nullptr, contact);
        }
    }

private:
    void both(const CastRay& ray, const Contact& contact) {
        const double sign = body_ == Side::a ? -1 : 1;
        const Vec3 normal{contact.normal.x, contact.normal.y, contact.normal.z};
        Difference d;
        d.normal = length(normal - sign * ray.normal);
        d.depth = std::fabs(contact.depth - ray.depth) / size_;
        d.ray_length = std::fabs(contact.ray_length - ray.ray_length) / size_;
        d.weight = std::fabs(contact.weight - ray.weight) / ray.weight;
        d.point = length(contact.point() - ray.point) / size_;
        if (direction_ == Direction::refined) return both_refined(ray, contact, d);
        const bool same = contact.feature.other_index() == target_.triangle_index[ray.triangle] && d.normal < 1e-4
                          && d.depth < 1e-5 && d.ray_length < 1e-5 && d.weight < 1e-6 && d.point < 1e-6
                          && contact.depth > 0;
        if (!same) return judge("other numbers", ray.vertex, &ray, &contact);
        ++sum_.agreed;
        sum_.worst_normal = std::max(sum_.worst_normal, d.normal);
        sum_.worst_depth = std::max(sum_.worst_depth, d.depth);
        sum_.worst_ray_length = std::max(sum_.worst_ray_length, d.ray_length);
        sum_.worst_weight = std::max(sum_.worst_weight, d.weight);
    }

    // The nearest point may be one of several triangles; so what is compared is how far it is, and that depth and
    // normal lead to the triangle that is named.
    void both_refined(const CastRay& ray, const Contact& contact, const Difference& d) {
        const auto face = static_cast<std::size_t>(
            std::ranges::find(target_.triangle_index, contact.feature.other_index()) - target_.triangle_index.begin());
        const Vec3 normal{contact.normal.x, contact.normal.y, contact.normal.z};
        const Vec3 way = (body_ == Side::a ? -1.0 : 1.0) * normal;
        const Vec3 end =
            rotate_back(target_pose_, contact.point() + double(contact.depth) * way - target_pose_.translation)
            - target_.centre;
        const auto& [p, q, r] = target_.triangles.at(face);
        const Vec3 on = closest_on_triangle(end, target_.vertices[p], target_.vertices[q], target_.vertices[r]);
        const bool other_answer = ray.least_depth < ray.depth - 1e-5 * size_
                                  && contact.depth > ray.least_depth - 1e-5 * size_
                                  && contact.depth < ray.depth - 1e-5 * size_;
        if (!(length(end - on) < 1e-5 * size_ && d.ray_length < 1e-5 && d.weight == 0 && d.point < 1e-6
              && contact.depth > 0 && (d.depth < 1e-5 || other_answer)))
            return judge("other numbers", ray.vertex, &ray, &contact);
        if (d.depth >= 1e-5) {
            ++sum_.excused;
            ++sum_.excuses["which faces count"];
            return;
        }
        ++sum_.agreed;
        sum_.worst_depth = std::max(sum_.worst_depth, d.depth);
        sum_.worst_ray_length = std::max(sum_.worst_ray_length, d.ray_length);
    }

    void judge(const char* what, std::uint32_t vertex, const CastRay* ray, const Contact* contact) {
        const Margins m = ray_margins(source_, source_pose_, target_, target_pose_, vertex);
        if (m.least() < excuse) {
            ++sum_.excused;
            ++sum_.excuses[m.name_of_least()];
            return;
        }
        const std::string margins =
            text(" (margins: edge %.2g, t_max %.2g, surface %.2g, bounds %.2g)", m.edge, m.t_max, m.surface, m.bounds);
        complain(what + margins, source_.vertex_index[vertex], ray, contact);
    }

    void complain(const std::string& what, std::uint32_t vertex, const CastRay* ray, const Contact* contact) {
        ++sum_.wrong;
        if (sum_.complaints.size() >= 5) return;
        std::string s = what + text(": vertex %u of ", vertex) + source_.name + " (body "
                        + (body_ == Side::a ? "a" : "b") + ") against " + target_.name;
        if (ray)
            s += text("\n  reference: triangle %u, depth %.9g, ray %.9g, weight %.9g, normal %.6g %.6g %.6g out of the "
                      "target",
                      target_.triangle_index[ray->triangle], ray->depth, ray->ray_length, ray->weight, ray->normal.x,
                      ray->normal.y, ray->normal.z);
        if (contact)
            s += text("\n  library: triangle %u, depth %.9g, ray %.9g, weight %.9g, normal %.6g %.6g %.6g",
                      contact->feature.other_index(), static_cast<double>(contact->depth),
                      static_cast<double>(contact->ray_length), static_cast<double>(contact->weight),
                      static_cast<double>(contact->normal.x), static_cast<double>(contact->normal.y),
                      static_cast<double>(contact->normal.z));
        s += "\n  source pose " + text(source_pose_) + "\n  target pose " + text(target_pose_);
        sum_.complaints.push_back(s);
    }

    const Solid& source_;
    const Solid& target_;
    const Pose& source_pose_;
    const Pose& target_pose_;
    Side body_;
    Direction direction_;
    Comparison& sum_;
    double size_;
};

} // namespace

void compare(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b, std::span<const Contact> contacts,
             Comparison& sum, Direction direction) {
    ++sum.pairs;
    OneWay(a, pose_a, b, pose_b, Side::a, direction, sum).run(contacts);
    OneWay(b, pose_b, a, pose_a, Side::b, direction, sum).run(contacts);
}

std::string Comparison::summary() const {
    std::string s =
        text("%llu pairs, %llu rays, %llu contacts: %llu agree (worst normal %.2g, depth %.2g, ray length "
             "%.2g, weight %.2g), %llu rays excused (%.4f %%), %llu wrong",
             static_cast<unsigned long long>(pairs), static_cast<unsigned long long>(rays),
             static_cast<unsigned long long>(contacts), static_cast<unsigned long long>(agreed), worst_normal,
             worst_depth, worst_ray_length, worst_weight, static_cast<unsigned long long>(excused),
             rays ? 100.0 * static_cast<double>(excused) / static_cast<double>(rays) : 0.0,
             static_cast<unsigned long long>(wrong));
    for (const auto& [name, count] : excuses)
        s += text("; by %s %llu", name.c_str(), static_cast<unsigned long long>(count));
    for (const std::string& complaint : complaints) s += "\n" + complaint;
    return s;
}

} // namespace raycontact::reference
