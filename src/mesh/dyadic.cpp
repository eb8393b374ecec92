// SPDX-License-Identifier: Apache-2.0
#include "mesh/dyadic.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

constexpr int bits = 32; // of a limb

} // namespace

Dyadic::Dyadic(double value) : sign_(value > 0 ? 1 : value < 0 ? -1 : 0) {
    if (sign_ == 0) return;
    constexpr int digits = 53;
    int exponent = 0;
    const auto whole = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::fabs(value), &exponent), digits));
    exponent -= digits;
    low_ = exponent >= 0 ? exponent / bits : -((bits - 1 - exponent) / bits);
    const int shift = exponent - bits * low_;
    const std::uint64_t low = whole << shift, high = shift > 0 ? whole >> (2 * bits - shift) : 0;
    limbs_ = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(low >> bits),
              static_cast<std::uint32_t>(high)};
    trim();
}

Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic product;
    product.sign_ = a.sign_ * b.sign_;
    if (product.sign_ == 0) return product;
    product.low_ = a.low_ + b.low_;
    product.limbs_.resize(a.limbs_.size() + b.limbs_.size());
    for (std::size_t i = 0; i < a.limbs_.size(); ++i) {
        std::uint64_t carry = 0;
        for (std::size_t k = 0; k < b.limbs_.size() || carry != 0; ++k) {
            carry += product.limbs_[i + k];
            if (k < b.limbs_.size()) carry += std::uint64_t{a.limbs_[i]} * b.limbs_[k];
            product.limbs_[i + k] = static_cast<std::uint32_t>(carry);
            carry >>= bits;
        }
    }
    product.trim();
    return product;
}

Dyadic Dyadic::sum_of(const Dyadic& a, const Dyadic& b, int sign_of_b) {
    Dyadic sum;
    sum.low_ = a.sign_ == 0 ? b.low_ : b.sign_ == 0 ? a.low_ : std::min(a.low_, b.low_);
    const int end = std::max(a.end(), b.end());
    bool swapped = false; // the larger one less the smaller one
    if (a.sign_ * sign_of_b < 0)
        for (int w = end - 1; w >= sum.low_; --w)
            if (a.limb(w) != b.limb(w)) {
                swapped = a.limb(w) < b.limb(w);
                break;
            }
    const Dyadic &first = swapped ? b : a, &second = swapped ? a : b;
    const bool adds = a.sign_ * sign_of_b >= 0;
    std::int64_t carry = 0;
    for (int w = sum.low_; w < end || carry > 0; ++w) {
        carry += first.limb(w);
        carry += adds ? std::int64_t{second.limb(w)} : -std::int64_t{second.limb(w)};
        sum.limbs_.push_back(static_cast<std::uint32_t>(carry));
        carry >>= bits;
    }
    sum.sign_ = swapped || a.sign_ == 0 ? sign_of_b : a.sign_;
    sum.trim();
    return sum;
}

std::uint32_t Dyadic::limb(int weight) const {
    return weight >= low_ && weight < end() ? limbs_[static_cast<std::size_t>(weight - low_)] : 0;
}

// The three highest limbs, times 2^-(32 (end() - 3)).
double Dyadic::top() const {
    constexpr double base = 4294967296.0;
    return sign_ * ((double(limb(end() - 1)) * base + double(limb(end() - 2))) * base + double(limb(end() - 3)));
}

void Dyadic::trim() {
    while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
    const auto first = std::ranges::find_if(limbs_, [](std::uint32_t limb) { return limb != 0; });
    low_ += static_cast<int>(first - limbs_.begin());
    limbs_.erase(limbs_.begin(), first);
    if (limbs_.empty()) *this = {};
}

double ratio(const Dyadic& a, const Dyadic& b) {
    if (a.sign_ == 0) return 0;
    return std::ldexp(a.top() / b.top(), bits * (a.end() - b.end()));
}

} // namespace raycontact
