// SPDX-License-Identifier: Apache-2.0
// Apart from types.h: a device without double knows nothing of it.
// NOLINTBEGIN(modernize-use-using): this text is C as well
// A body in the world: the frame about its shape's centre, in double, as the host has it.
typedef struct {
    double rotation[9];
    double translation[3];
    uint shape;
    uint slot;
} BodyPlace;
WIRE_SIZE(BodyPlace, 104);
// NOLINTEND(modernize-use-using)
