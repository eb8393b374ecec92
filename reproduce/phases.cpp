// SPDX-License-Identifier: Apache-2.0
#include <reproduce/phases.h>

#include <algorithm>

namespace raycontact::reproduce {

namespace {
constexpr double no_time = 1e-6; // milliseconds: below any clock's resolution, and never zero
} // namespace

std::vector<Phase> phases(const Series& full, const Series& ordered_pairs) {
    const std::size_t seconds = (full.size() + second - 1) / second;
    std::vector<double> share(seconds, -1);
    double least = 1, most = 0;
    for (std::size_t s = 0; s < seconds; ++s) {
        double part = 0, whole = 0;
        for (std::size_t i = s * second; i < std::min(full.size(), (s + 1) * second); ++i) {
            part += full[i];
            whole += ordered_pairs[i];
        }
        if (!(whole > 0)) continue;
        share[s] = part / whole;
        least = std::min(least, share[s]);
        most = std::max(most, share[s]);
    }
    std::vector<Phase> result(full.size(), Phase::c);
    for (std::size_t i = 0; i < full.size(); ++i) {
        const double own = share[i / second];
        if (own >= 0 && (own > (least + most) / 2 || least >= most)) result[i] = Phase::b;
    }
    return result;
}

double speed_up(const Series& first_ms, const Series& second_ms, const std::vector<Phase>& phase, Phase which) {
    const bool any = std::find(phase.begin(), phase.end(), which) != phase.end();
    double first = no_time, other = no_time;
    for (std::size_t i = 0; i < phase.size(); ++i) {
        if (any && phase[i] != which) continue;
        first += first_ms[i];
        other += second_ms[i];
    }
    return first / other;
}

double of_second(const Series& first_ms, const Series& second_ms, std::size_t from) {
    double first = no_time, other = no_time;
    for (std::size_t i = from; i < std::min(first_ms.size(), from + second); ++i) {
        first += first_ms[i];
        other += second_ms[i];
    }
    return first / other;
}

double best_second(const Series& first_ms, const Series& second_ms) {
    double best = 0;
    for (std::size_t from = 0; from < first_ms.size(); from += second)
        best = std::max(best, of_second(first_ms, second_ms, from));
    return best;
}

} // namespace raycontact::reproduce
