// SPDX-License-Identifier: Apache-2.0
// Not in types.h, so that a device without double need not compile it. A body's pose in the world: the frame at its
// shape's centre, in double, as the host has it.
STRUCT(BodyPlace) {
    double rotation[9];
    double translation[3];
    uint shape;
    uint slot;
};
WIRE_SIZE(BodyPlace, 104);
