// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace raycontact {

/// Of degree N; coefficients by ascending power.
template <std::size_t N>
struct Polynomial {
    std::array<double, N + 1> c{};

    double operator()(double x) const {
        double sum = 0;
        for (std::size_t k = N + 1; k-- > 0;) sum = sum * x + c[k];
        return sum;
    }
    Polynomial<N - 1> slope() const requires(N > 0) {
        Polynomial<N - 1> s;
        for (std::size_t k = 1; k <= N; ++k) s.c[k - 1] = double(k) * c[k];
        return s;
    }
};

/// Places, ascending.
template <std::size_t N>
struct Places {
    std::array<double, N> at{};
    std::size_t count = 0;
};

/// Where it changes its sign between 0 and 1: between its own turning points it does so at most once. fall: only from
/// above 0.
template <std::size_t N>
Places<N> sign_changes(const Polynomial<N>& p, bool fall) {
    Places<N> found;
    std::array<double, N + 1> ends{}; // of the pieces without a turning point
    std::size_t pieces = 0;
    if constexpr (N > 1) {
        const Places<N - 1> turns = sign_changes(p.slope(), false);
        for (std::size_t i = 0; i < turns.count; ++i) ends[++pieces] = turns.at[i];
    }
    ends[++pieces] = 1;
    for (std::size_t i = 0; i < pieces; ++i) {
        double from = ends[i], to = ends[i + 1];
        const bool above = p(from) > 0;
        if (above == (p(to) > 0) || (fall && !above)) continue;
        for (double middle = (from + to) / 2; from < middle && middle < to; middle = (from + to) / 2)
            ((p(middle) > 0) == above ? from : to) = middle;
        found.at[found.count++] = to;
    }
    return found;
}

} // namespace raycontact
