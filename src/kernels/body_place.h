// SPDX-License-Identifier: Apache-2.0
// Apart from types.h: a device without double knows nothing of it.
// A body in the world: the frame about its shape's centre, in double, as the host has it.
STRUCT(BodyPlace) {
    double rotation[9];
    double translation[3];
    uint shape;
    uint slot;
};
WIRE_SIZE(BodyPlace, 104);
