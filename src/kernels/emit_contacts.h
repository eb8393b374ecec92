// SPDX-License-Identifier: Apache-2.0
// Hits become contacts in count, scan, write form: their order is a key, never a race.

// With positive depth: a ray that only grazes the face it leaves through separates nothing.
DEVICE uint is_contact(const Hit hit) {
    return (uint)(hit.triangle != NONE) & (uint)(hit.distance * hit.facing > 0.0f);
}

KERNEL void count_contacts(RANGE uint count, GLOBAL const Hit* RESTRICT hits, GLOBAL uint* RESTRICT contacts,
                           GLOBAL uint* RESTRICT sides) {
    FOR_EACH(i, count) {
        const Hit hit = hits[i];
        contacts[i] = is_contact(hit);
        sides[i] = hit.sides;
    }
}

KERNEL void write_contacts(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                           GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const VertexBlock* RESTRICT vertices,
                           GLOBAL const Packed3* RESTRICT normals, GLOBAL const Ray* RESTRICT rays,
                           GLOBAL const Hit* RESTRICT hits, GLOBAL const uint* RESTRICT firsts,
                           GLOBAL LocalContact* RESTRICT contacts) {
    FOR_EACH(i, count) {
        const Hit hit = hits[i];
        if (is_contact(hit) != 0u) {
            const Ray ray = rays[i];
            LocalContact contact;
            contact.pair = ray.pair;
            contact.vertex = vertices[ray.slot / VERTEX_LANES].vertex[ray.slot % VERTEX_LANES];
            contact.triangle = hit.triangle;
            contact.distance = hit.distance;
            contact.facing = hit.facing;
            contact.normal = normals[shapes[pairs[ray.pair].target].normal_first + hit.triangle];
            contacts[firsts[i]] = contact;
        }
    }
}
