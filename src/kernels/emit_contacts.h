// SPDX-License-Identifier: Apache-2.0
// Writes the hits that record_hit() counted as contacts, in the order of the rays.
KERNEL void write_contacts(COUNT(count), READS(DirectedPair) pairs, READS(ShapeHeader) shapes,
                           READS(VertexBlock) vertices, READS(Packed3) normals, READS(Ray) rays, READS(Hit) hits,
                           READS(uint) firsts, WRITES(LocalContact) contacts) {
    FOR_EACH(i, count) {
        const Hit hit = hits[i];
        if (is_contact(hit) != 0u) {
            const Ray ray = rays[i];
            LocalContact contact;
            contact.pair = ray.pair;
            contact.vertex = vertices[ray.vertex_lane / VERTEX_LANES].vertex[ray.vertex_lane % VERTEX_LANES];
            contact.triangle = hit.triangle;
            contact.distance = hit.distance;
            contact.facing = hit.facing;
            contact.normal = normals[shapes[pairs[ray.pair].target].normal_first + hit.triangle];
            contacts[firsts[i]] = contact;
        }
    }
}
