// soup_importer.h: OpenMesh's readers as parsers only: vertices and faces as they come out, before
// any half-edge mesh refuses some of them (and, for a face with a repeated vertex, ends the
// process).
#pragma once

#include <OpenMesh/Core/IO/importer/BaseImporter.hh>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pagoda::test {

class SoupImporter : public OpenMesh::IO::BaseImporter {
public:
    std::vector<OpenMesh::Vec3d> points;
    std::vector<std::vector<uint32_t>> faces;

    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& point) override {
        return add_vertex(OpenMesh::Vec3d(point));
    }
    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3d& point) override {
        points.push_back(point);
        return OpenMesh::VertexHandle(static_cast<int>(points.size() - 1));
    }
    OpenMesh::VertexHandle add_vertex() override { return add_vertex(OpenMesh::Vec3d(0.0)); }
    void set_point(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& point) override {
        points.at(static_cast<size_t>(vertex.idx())) = OpenMesh::Vec3d(point);
    }
    OpenMesh::FaceHandle add_face(const VHandles& corners) override {
        std::vector<uint32_t>& face = faces.emplace_back();
        for (const OpenMesh::VertexHandle corner : corners) {
            face.push_back(static_cast<uint32_t>(corner.idx()));
        }
        return OpenMesh::FaceHandle(static_cast<int>(faces.size() - 1));
    }
    [[nodiscard]] size_t n_vertices() const override { return points.size(); }
    [[nodiscard]] size_t n_faces() const override { return faces.size(); }
    [[nodiscard]] size_t n_edges() const override { return 0; }

    // Half-edges, of the .om format only, and attributes: not compared.
    using Vertex = OpenMesh::VertexHandle;
    using Halfedge = OpenMesh::HalfedgeHandle;
    using Edge = OpenMesh::EdgeHandle;
    using Face = OpenMesh::FaceHandle;
    using Status = OpenMesh::Attributes::StatusInfo;
    Halfedge add_edge(Vertex, Vertex) override { return Halfedge(); }
    Face add_face(Halfedge) override { return Face(); }
    void add_face_texcoords(Face, Vertex, const std::vector<OpenMesh::Vec2f>&) override {}
    void add_face_texcoords(Face, Vertex, const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(Face, int) override {}
    void set_halfedge(Vertex, Halfedge) override {}
    void set_normal(Vertex, const OpenMesh::Vec3f&) override {}
    void set_normal(Vertex, const OpenMesh::Vec3d&) override {}
    void set_color(Vertex, const OpenMesh::Vec3uc&) override {}
    void set_color(Vertex, const OpenMesh::Vec4uc&) override {}
    void set_color(Vertex, const OpenMesh::Vec3f&) override {}
    void set_color(Vertex, const OpenMesh::Vec4f&) override {}
    void set_texcoord(Vertex, const OpenMesh::Vec2f&) override {}
    void set_texcoord(Vertex, const OpenMesh::Vec3f&) override {}
    void set_status(Vertex, const Status&) override {}
    void set_next(Halfedge, Halfedge) override {}
    void set_face(Halfedge, Face) override {}
    void request_face_texcoords2D() override {}
    void set_texcoord(Halfedge, const OpenMesh::Vec2f&) override {}
    void set_texcoord(Halfedge, const OpenMesh::Vec3f&) override {}
    void set_status(Halfedge, const Status&) override {}
    void set_color(Edge, const OpenMesh::Vec3uc&) override {}
    void set_color(Edge, const OpenMesh::Vec4uc&) override {}
    void set_color(Edge, const OpenMesh::Vec3f&) override {}
    void set_color(Edge, const OpenMesh::Vec4f&) override {}
    void set_status(Edge, const Status&) override {}
    void set_normal(Face, const OpenMesh::Vec3f&) override {}
    void set_normal(Face, const OpenMesh::Vec3d&) override {}
    void set_color(Face, const OpenMesh::Vec3uc&) override {}
    void set_color(Face, const OpenMesh::Vec4uc&) override {}
    void set_color(Face, const OpenMesh::Vec3f&) override {}
    void set_color(Face, const OpenMesh::Vec4f&) override {}
    void set_status(Face, const Status&) override {}
    void add_texture_information(int, std::string) override {}
};

}  // namespace pagoda::test
