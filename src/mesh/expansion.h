// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace raycontact {

/// A sum of doubles that do not overlap, by rising magnitude: the last one has the sign of the sum. Every operation is
/// `add`, which is exact for any summand (Shewchuk 1997, theorem 10); zeros are left out. Room: parts at most.
template <std::size_t Room>
class Expansion {
public:
    Expansion() = default;
    Expansion(double a, double b) { // a - b
        add(a);
        add(-b);
    }

    void add(double summand) {
        double carry = summand;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const double part = parts_[i];
            const double sum = carry + part;
            const double shadow = sum - carry;
            const double error = (carry - (sum - shadow)) + (part - shadow);
            carry = sum;
            if (error != 0) parts_[kept++] = error;
        }
        if (carry != 0) parts_[kept++] = carry;
        size_ = kept;
    }

    /// Adds a * b.
    void add_product(double a, double b) {
        const double product = a * b;
        add(std::fma(a, b, -product));
        add(product);
    }

    /// Adds sign * a * b.
    template <std::size_t RoomA, std::size_t RoomB>
    void add_product(const Expansion<RoomA>& a, const Expansion<RoomB>& b, double sign) {
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t k = 0; k < b.size(); ++k) add_product(sign * a[i], b[k]);
    }

    /// Adds sign * other.
    template <std::size_t RoomOther>
    void add(const Expansion<RoomOther>& other, double sign) {
        for (std::size_t i = 0; i < other.size(); ++i) add(sign * other[i]);
    }

    std::size_t size() const { return size_; }
    double operator[](std::size_t i) const { return parts_[i]; }
    int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

private:
    std::array<double, Room> parts_;
    std::size_t size_ = 0;
};

} // namespace raycontact
