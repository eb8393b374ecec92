// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/entrants.h>

#include <ode/ode.h>

#include <cstdarg>
#include <stdexcept>

namespace raycontact::bench {

namespace {

constexpr int most_contacts = 0xffff; // all that dCollide's flags can ask for

/// ODE's own start and end; once for the program.
struct Library {
    Library() {
        if (!dInitODE2(0) || !dAllocateODEDataForThread(dAllocateMaskAll))
            throw std::runtime_error("ODE cannot be started");
        // It says on stderr whenever its table for merging close contacts is full, thousands of times.
        dSetMessageHandler([](int, const char*, va_list) {});
    }
    ~Library() { dCloseODE(); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
};

struct OdeMesh {
    explicit OdeMesh(const Shape& shape) : data(dGeomTriMeshDataCreate()) {
        for (const Vec3& v : shape.vertices()) points.insert(points.end(), {v.x, v.y, v.z});
        for (const auto& t : shape.triangles()) corners.insert(corners.end(), t.begin(), t.end());
        dGeomTriMeshDataBuildDouble(data, points.data(), 3 * sizeof(double), static_cast<int>(points.size() / 3),
                                    corners.data(), static_cast<int>(corners.size()), 3 * sizeof(dTriIndex));
    }
    ~OdeMesh() { dGeomTriMeshDataDestroy(data); }
    OdeMesh(const OdeMesh&) = delete;
    OdeMesh& operator=(const OdeMesh&) = delete;
    std::vector<double> points;
    std::vector<dTriIndex> corners;
    dTriMeshDataID data;
};

class Ode : public Peer {
public:
    explicit Ode(const Work& work) : contacts_(most_contacts) {
        static const Library library;
        for (const auto& shape : work.shapes) meshes_.push_back(std::make_unique<OdeMesh>(*shape));
        for (const std::uint32_t shape : work.body_shape)
            geoms_.push_back(dCreateTriMesh(nullptr, meshes_[shape]->data, nullptr, nullptr, nullptr));
    }
    ~Ode() override {
        for (const dGeomID geom : geoms_) dGeomDestroy(geom);
    }
    Ode(const Ode&) = delete;
    Ode& operator=(const Ode&) = delete;

    Found detect(const WorkStep& step) override {
        for (std::size_t body = 0; body < geoms_.size(); ++body) {
            const Pose& pose = step.poses[body];
            const auto& r = pose.rotation;
            const dVector3 at{pose.translation.x, pose.translation.y, pose.translation.z, 0};
            const dMatrix3 rotation{r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0};
            // Its manual asks for the pose of the step before, which tells it how triangles move.
            const dReal* p = dGeomGetPosition(geoms_[body]);
            const dReal* q = dGeomGetRotation(geoms_[body]);
            const dMatrix4 last{q[0], q[1], q[2], p[0], q[4], q[5], q[6], p[1], q[8], q[9], q[10], p[2], 0, 0, 0, 1};
            dGeomTriMeshSetLastTransform(geoms_[body], last);
            dGeomSetPosition(geoms_[body], at[0], at[1], at[2]);
            dGeomSetRotation(geoms_[body], rotation);
        }
        Found found;
        for (const Pair& pair : step.pairs) {
            const int count = dCollide(geoms_[pair.first.slot], geoms_[pair.second.slot], most_contacts,
                                       contacts_.data(), static_cast<int>(sizeof(dContactGeom)));
            for (int i = 0; i < count; ++i) found.depth_sum += contacts_[static_cast<std::size_t>(i)].depth;
            found.contacts += static_cast<std::uint64_t>(count);
        }
        return found;
    }

private:
    std::vector<std::unique_ptr<OdeMesh>> meshes_;
    std::vector<dGeomID> geoms_;
    std::vector<dContactGeom> contacts_;
};

} // namespace

Entrant ode() {
    return entrant_of<Ode>("ode", "ODE " RAYCONTACT_ODE_VERSION " trimesh-trimesh (OPCODE), double, dCollide");
}

} // namespace raycontact::bench
