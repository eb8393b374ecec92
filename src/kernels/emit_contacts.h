// SPDX-License-Identifier: Apache-2.0
// Writes the hits that record_hit() counted as contacts, in the order of the rays.
KERNEL void write_contacts(COUNT(count), READS(DirectedPair) pairs, READS(ShapeHeader) shapes, READS(ulong) memory,
                           READS(Ray) rays, READS(Hit) hits, READS(uint) firsts, WRITES(LocalContact) contacts) {
    FOR_EACH(i, count) {
        const Hit hit = hits[i];
        if (is_contact(hit) != 0u) {
            const Ray ray = rays[i];
            READS(DirectedPair) pair = pairs + ray.pair;
            LocalContact contact;
            contact.pair = ray.pair;
            contact.vertex = source_block(pair, shapes, memory, ray.vertex_lane / VERTEX_LANES)
                                 ->vertex[ray.vertex_lane % VERTEX_LANES];
            contact.triangle = hit.triangle;
            contact.distance = hit.distance;
            contact.facing = hit.facing;
            contact.normal = AT(memory, Packed3, shapes[pair->target].face_normals)[hit.triangle];
            contacts[firsts[i]] = contact;
        }
    }
}
