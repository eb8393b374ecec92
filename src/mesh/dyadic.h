// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace raycontact {

/// A whole number times a power of two: what sums and products of doubles are, exactly and of any size. Slow: for what
/// predicates leave open.
class Dyadic {
public:
    Dyadic() = default;
    Dyadic(double value); // NOLINT(google-explicit-constructor): a double is one

    int sign() const { return sign_; }

    friend Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum_of(a, b, b.sign_); }
    friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum_of(a, b, -b.sign_); }
    friend Dyadic operator*(const Dyadic& a, const Dyadic& b);
    friend Dyadic abs(Dyadic a) {
        a.sign_ *= a.sign_;
        return a;
    }
    /// a / b, right to some 1e-15 of itself. b: not 0.
    friend double ratio(const Dyadic& a, const Dyadic& b);

private:
    static Dyadic sum_of(const Dyadic& a, const Dyadic& b, int sign_of_b);
    std::uint32_t limb(int weight) const; ///< that of 2^(32 weight)
    int end() const { return low_ + static_cast<int>(limbs_.size()); }
    double top() const;
    void trim();

    std::vector<std::uint32_t> limbs_; ///< of the magnitude, the lowest first
    int low_ = 0;                      ///< the first limb counts 2^(32 low_)
    int sign_ = 0;                     ///< 0: it is 0, and has no limbs
};

double ratio(const Dyadic& a, const Dyadic& b);

} // namespace raycontact
