// SPDX-License-Identifier: Apache-2.0
// The structs in device buffers: scalars only, sizes checked, offsets instead of pointers (ShapeHeader has places).

// Pointers into buffers, without aliases: to data that is only read, and to data that is written (and may be read).
#define READS(type) GLOBAL const type* RESTRICT
#define WRITES(type) GLOBAL type* RESTRICT

#define STRUCT(name)                                                                                                   \
    typedef struct name name;                                                                                          \
    struct name
// Rows of lanes, each of a cache line.
#define STRUCT_OF_ROWS(name)                                                                                           \
    typedef struct name name;                                                                                          \
    struct IN_LINES name

#define TRIANGLE_LANES 16
#define NODE_LANES 16
#define VERTEX_LANES 16
#define CLUSTER_LEVELS 4
#define SEGMENT_CANDIDATES 32u // a bit each
#define MASK_WORDS 4u          // of 64 blocks each, for each pair
#define NODE_LEVELS 5
#define NONE 0xffffffffu
#define LEAF 0x80000000u
#define UNBOUNDED 3.0e38f

// Of the smaller body's diagonal: what is thrown is followed no farther (docs/internals/speculative.md, Thin bodies).
#define MOST_THROWN 0.05f
// A word of a clearance grid: a ball that contains no surface. Bits 0 to 14: the cell of its middle, relative to the
// word's cell, plus CLEARANCE_OFFSET. Bit 15: it is outside. The rest: its radius in steps, CLEARANCE_STEPS a cell.
#define CLEARANCE_OFFSET 16
#define CLEARANCE_OUTSIDE 0x8000u
#define CLEARANCE_STEPS 2048

// One kernel scans up to so many items; more take three kernels.
#define SCAN_AT_ONCE 65536u
#define SCAN_ITEMS 8u // of a thread, one after the other
#define MOST_COLUMNS 4

#define WIRE_SIZE(type, bytes) typedef char wire_size_of_##type[sizeof(type) == (bytes) ? 1 : -1]

// Sixteen triangles, structure of arrays; corner[3 * corner + axis][lane]. Empty lanes hold NaN, which fails every
// test.
STRUCT_OF_ROWS(TriangleBlock) {
    float corner[9][TRIANGLE_LANES];
    uint triangle[TRIANGLE_LANES];
};
WIRE_SIZE(TriangleBlock, 640);

// Sixteen child boxes, grown by the rounding error of a ray test (docs/internals/devices.md). bounds[axis] are the
// lower planes, bounds[3 + axis] the upper ones. child: a node, or LEAF | triangle block. Empty lanes have inverted
// boxes.
STRUCT_OF_ROWS(Node) {
    float bounds[6][NODE_LANES];
    uint child[NODE_LANES];
    uint parent;
    uint unused[15];
};
WIRE_SIZE(Node, 512);

// Sixteen vertices that cast rays. direction: the inward normal. exit: distance at which the ray leaves its own mesh.
// Or sixteen edges. position: the middle. direction: from there to the end. exit: what it hides, metres
// (docs/internals/edges.md). vertex: 3 x the edge's lowest triangle + its first corner.
STRUCT_OF_ROWS(VertexBlock) {
    float position[3][VERTEX_LANES];
    float direction[3][VERTEX_LANES];
    float exit[VERTEX_LANES];
    uint vertex[VERTEX_LANES];
};
WIRE_SIZE(VertexBlock, 512);

// Boxes of sixteen blocks of the level below: centre and half size. Empty lanes hold NaN.
STRUCT_OF_ROWS(ClusterBlock) {
    float centre[3][VERTEX_LANES];
    float half_size[3][VERTEX_LANES];
    float hides[VERTEX_LANES]; // what an edge below hides, at most, metres (docs/internals/edges.md); of vertices
                               // UNBOUNDED
};
WIRE_SIZE(ClusterBlock, 448);

// Which edges of a directed pair are sought, by what they hide, metres. One that hides less than `least` may be left
// out, one that hides less than least_ahead is sought by `ahead` less far.
STRUCT(EdgeChoice) {
    float least, least_ahead, ahead;
};
WIRE_SIZE(EdgeChoice, 12);

// Where a triangle lies among the blocks (TRIANGLE_LANES * block + lane, NONE without area), and the triangles across
// its edges 0-1, 1-2, 2-0 (NONE at a border).
STRUCT(Face) {
    uint triangle_lane;
    uint neighbour[3];
};
WIRE_SIZE(Face, 16);

// A connected component of a mesh: its lowest vertex, and its box.
STRUCT(Component) {
    float vertex[3];
    float low[3], high[3];
};
WIRE_SIZE(Component, 36);

STRUCT(Packed3) {
    float x, y, z;
};
WIRE_SIZE(Packed3, 12);

// The vertices, or the edges, of a shape as sources: their blocks, and the tree of clusters above these.
STRUCT(SourceTree) {
    uint block_first, block_count;
    uint cluster_first[CLUSTER_LEVELS]; // level 0 bounds blocks, level l + 1 bounds clusters of level l
    uint cluster_count[CLUSTER_LEVELS];
    uint cluster_levels;
};
WIRE_SIZE(SourceTree, 44);

// Where a shape's arrays are, in ulongs behind the buffer that holds all shapes, or behind address 0 where the host's
// memory is shared; AT() gives the array. And the rounding it allows for.
STRUCT(ShapeHeader) {
    ulong nodes, triangle_blocks, vertex_blocks, clusters;
    ulong faces, face_normals; // by triangle; outward
    ulong outside_cells;       // a bit for each cell, x fastest
    ulong clearances;          // x fastest
    ulong normal_cones;        // by triangle_lane (normal_cone.h); only where the host's memory is shared
    ulong components;          // connected ones
    uint triangle_block_count, component_count;
    SourceTree vertices, edges;
    uint closed;
    uint outward;      // closed, winding number 1 inside, 0 outside: a vertex outside cannot touch
    float tolerance;   // metres: distances of two hits closer than this are not told apart
    uint grid_size[3]; // of outside_cells, cells; 0: no grid
    float grid_low[3];
    float grid_scale;                          // cells a metre
    uint clearance_size[3];                    // cells
    float clearance_low[3], clearance_high[3]; // a box around that of the shape
    float clearance_scale;                     // cells a metre
    float clearance_cell;                      // metres a cell
    float clearance_unit;                      // metres a step of the stored lengths
    uint cones_pay;                            // most triangles have normal-cone balls: it pays to test them
    float low[3], high[3];                     // the box
    float ray_reach;  // metres that rays from its vertices may go beyond the bounds of an open mesh
    float least_exit; // the shortest way of such a ray out of its own mesh, metres
};
WIRE_SIZE(ShapeHeader, 304);

#include "kernels/body_place.h"

#include "kernels/body_box.h"

// The bodies of a pair; NONE: the slot has no pair.
STRUCT(PairBodies) {
    uint first, second;
};
WIRE_SIZE(PairBodies, 8);

// A body's place along a curve, and its slot.
STRUCT(SortKey) {
    uint key;
    uint slot;
};
WIRE_SIZE(SortKey, 8);

// Sixteen boxes of bodies in the world, or of nodes of the level below, rounded outward: bounds as a Node's. Empty
// lanes have inverted boxes.
STRUCT_OF_ROWS(BoxNode) {
    float bounds[6][NODE_LANES];
};
WIRE_SIZE(BoxNode, 384);

STRUCT(PairChange) {
    uint slot;
    PairBodies bodies;
};
WIRE_SIZE(PairChange, 12);

// A directed pair: the pose of the source in the target's frame, and the box in that frame in which vertices cast rays
// (inclusive). source NONE: the slot has no pair.
STRUCT(DirectedPair) {
    float rotation[9];
    float translation[3];
    float bounds[6]; // lower x y z, upper x y z
    uint source;     // shapes
    uint target;
};
WIRE_SIZE(DirectedPair, 80);

// A block of vertices or edges that may reach into its pair's target.
STRUCT(PairBlock) {
    uint pair;
    uint vertex_block; // of the source
    uint lanes;        // a bit for each vertex or edge that is cast
    uint clear;        // of edges that are not: how far they stay so, in tolerances of the target (count_edges)
};
WIRE_SIZE(PairBlock, 16);

// A ray that is followed from step to step: its vertex, and the triangle it met last.
STRUCT(CachedRay) {
    uint vertex_lane; // VERTEX_LANES * vertex block + lane
    uint triangle;
};
WIRE_SIZE(CachedRay, 8);

// How a pair's rays ended. kept: cached rays for the next step; predictions: those of them without contact. lost: walks
// that ended nowhere. cast: rays cast in full, after such a walk or in a full test.
STRUCT(Followed) {
    uint kept;
    uint predictions;
    uint walks;
    uint lost;
    uint cast;
};
WIRE_SIZE(Followed, 20);

// A vertex block near its pair's target. lanes: vertices that could be in contact; their rays are decided in each step.
// The others cannot be in contact before the pair's clock exceeds `valid_until`.
STRUCT(CandidateBlock) {
    uint vertex_block; // of the source
    float valid_until; // metres
    uint lanes;
};
WIRE_SIZE(CandidateBlock, 12);

// Part of a pair's candidates, at most SEGMENT_CANDIDATES, or of its cached rays. now: its clock, metres. margin: the
// rounding that a certificate must exceed, metres.
STRUCT(Segment) {
    uint pair;
    uint first, count;
    float now;
    float margin;
};
WIRE_SIZE(Segment, 20);

// The result of testing a segment's candidates. valid_until: the least of theirs. blocks: number tested. rays: number
// to be decided. casting: a bit for each candidate that has rays.
STRUCT(CandidateTest) {
    uint casting;
    float valid_until;
    uint blocks;
    uint rays;
};
WIRE_SIZE(CandidateTest, 16);

// What is kept of a ray between steps. With a swept clearance, one triangle or none decides it while no point of it has
// moved by `safe`. Without a swept clearance, its triangle's normal-cone ball is tested, if it has one; else it is
// cast. Lengths along the ray count in lengths of its direction.
STRUCT(Held) {
    uint vertex_lane; // VERTEX_LANES * vertex block + lane
    uint triangle;    // TRIANGLE_LANES * block + lane of its shape, NONE: none is near, or none is known
    float safe;       // metres; 0: it has no swept clearance
    float
        limit; // along the ray: where its swept clearance ends; without a swept clearance: steps until the next search
    float position[3]; // when the clearance was searched
    float direction[3];
};
WIRE_SIZE(Held, 40);

// The rays kept of a directed pair. first, count: those of the last step, in the array of Held; now_first: where those
// of this step begin. margin: metres of rounding. radius: of the swept clearances to search, metres; 0: none, the pair
// is too fast. tests_cones: 1: rays test the normal-cone balls of the target.
STRUCT(HeldRange) {
    uint first, count; // Held
    uint now_first;
    float margin;
    float radius;
    uint tests_cones;
};
WIRE_SIZE(HeldRange, 24);

STRUCT(Ray) {
    uint pair;
    uint vertex_lane; // VERTEX_LANES * vertex block + lane
};
WIRE_SIZE(Ray, 8);

// triangle: of the target shape, NONE without contact. facing: ray direction . face normal, so that the re-projected
// depth is distance * facing (paper section 3.2). sides: extra directions cast to tell inside from outside.
STRUCT(Hit) {
    uint triangle;
    float distance;
    float facing;
    uint sides;
};
WIRE_SIZE(Hit, 16);

// The results of a scan. items: the number of items whose results are to be written; 0 if there are no results or no
// room. results: the number of results, with those before (ScanOf); 0 if there is no room. sums: of the columns,
// whether or not there is room; NONE if 32 bits cannot hold one.
STRUCT(Totals) {
    uint items;
    uint results;
    uint sums[MOST_COLUMNS];
};
WIRE_SIZE(Totals, 24);

STRUCT(LocalContact) {
    uint pair;
    uint vertex;   // of the source shape
    uint triangle; // of the target shape
    float distance;
    float facing;
    Packed3 normal; // of the face, target frame
};
WIRE_SIZE(LocalContact, 32);

// The faces near an edge that was cast: how many, and the first ones.
#define EDGE_FACES 7u
STRUCT(EdgeHits) {
    uint count;
    uint face[EDGE_FACES];
};
WIRE_SIZE(EdgeHits, 32);

// An edge of the source that may cross a face of the target, or comes near: 3 x its lowest triangle + its first corner.
// Or a vertex that comes near.
STRUCT(NearEdge) {
    uint edge;
    uint face;
    uint pair;
};
WIRE_SIZE(NearEdge, 12);
