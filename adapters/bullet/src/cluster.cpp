// SPDX-License-Identifier: Apache-2.0
#include <cluster.h>

#include <algorithm>

namespace raycontact::bullet {

namespace {

constexpr btScalar advantage = btScalar(1.3);
constexpr btScalar worst = -BT_LARGE_FLOAT;

/// Index of the best score among those not taken; -1 when none scores above `floor`.
template <class Score>
int best(const std::vector<Applicant>& all, const std::vector<int>& taken, btScalar floor, Score&& score) {
    int found = -1;
    btScalar top = floor;
    for (int i = 0; i < static_cast<int>(all.size()); ++i) {
        if (std::find(taken.begin(), taken.end(), i) != taken.end()) continue;
        btScalar s = score(all[static_cast<std::size_t>(i)]);
        if (all[static_cast<std::size_t>(i)].present && s > 0) s *= advantage;
        if (s > top) {
            top = s;
            found = i;
        }
    }
    return found;
}

} // namespace

std::vector<int> choose_points(const std::vector<Applicant>& applicants) {
    std::vector<int> taken;
    if (applicants.size() <= 4) {
        for (int i = 0; i < static_cast<int>(applicants.size()); ++i) taken.push_back(i);
        return taken;
    }
    const auto at = [&](std::size_t k) -> const btVector3& {
        return applicants[static_cast<std::size_t>(taken[k])].position;
    };
    const auto deepest = [&] { return best(applicants, taken, worst, [](const Applicant& a) { return a.depth; }); };

    taken.push_back(deepest());
    int next = best(applicants, taken, 0, [&](const Applicant& a) { return (a.position - at(0)).length2(); });
    taken.push_back(next >= 0 ? next : deepest());
    const btVector3 edge = at(1) - at(0);
    next = best(applicants, taken, 0, [&](const Applicant& a) { return edge.cross(a.position - at(0)).length2(); });
    taken.push_back(next >= 0 ? next : deepest());
    const btVector3 face = edge.cross(at(2) - at(0));
    // Beyond one of the triangle's edges the quadrilateral grows; within the triangle the deepest serves better.
    next = best(applicants, taken, btScalar(1e-3) * face.length2(), [&](const Applicant& a) {
        btScalar most = worst;
        for (std::size_t k = 0; k < 3; ++k) {
            const btVector3& from = at(k);
            most = btMax(most, -(at((k + 1) % 3) - from).cross(a.position - from).dot(face));
        }
        return most;
    });
    taken.push_back(next >= 0 ? next : deepest());
    std::sort(taken.begin(), taken.end());
    return taken;
}

} // namespace raycontact::bullet
