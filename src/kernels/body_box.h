// SPDX-License-Identifier: Apache-2.0
// Not in types.h, as body_place.h. What the broad phase knows of a body, in double.

// Its box in its own frame, already grown, and its filter. there: IS_THERE and IS_STATIC; 0: the slot has no body.
#define IS_THERE 1u
#define IS_STATIC 2u
STRUCT(BodyExtent) {
    double middle[3], half_size[3];
    uint groups, mask;
    uint there;
    uint slot;
};
WIRE_SIZE(BodyExtent, 64);

// Its box in the world. Of a slot without a body: a box that touches nothing.
STRUCT(WorldBox) {
    double low[3], high[3];
    uint groups, mask;
    uint moves, unused; // moves 0: it is static
};
WIRE_SIZE(WorldBox, 64);

// A pair that was not in the last list, or, opened 0, is not any more.
STRUCT(PairDifference) {
    uint first, second;
    uint opened;
};
WIRE_SIZE(PairDifference, 12);
