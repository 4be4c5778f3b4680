// A surface in space: a map of polygons with positions. Particles move within it.
//
// A polygon is a fan around its lowest-numbered corner (dartcast/cell_shape.hpp). The triangles of the fans are the
// surface, so it has no gaps however it is bent. A particle's place is a triangle and weights in it. So no particle can
// leave the surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/cell_shape.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A place on a surface: a triangle of a face's fan, and barycentric coordinates in it, none negative. On an edge one
/// of them is exactly 0, at a vertex two. A place needs no update when the surface bends, because it moves with the
/// surface.
struct SurfacePlace {
  SimplexId triangle;
  std::array<double, 3> weights = {1.0, 0.0, 0.0};

  /// The kind of the place: inside the triangle, on an edge, or at a vertex.
  [[nodiscard]] Kind kind() const {
    const int zeros = (weights[0] == 0.0 ? 1 : 0) + (weights[1] == 0.0 ? 1 : 0) + (weights[2] == 0.0 ? 1 : 0);
    return zeros == 0 ? Kind::face : zeros == 1 ? Kind::edge : Kind::vertex;
  }
  bool operator==(const SurfacePlace&) const = default;
};

/// The other side of an edge of a triangle; edge i is opposite to corner i.
struct AcrossEdge {
  CellFace face;       ///< the map's edge, of the cell left behind; invalid within a polygon
  SimplexId triangle;  ///< invalid at an open border
  unsigned edge = 0;   ///< of that triangle
  bool wall = false;   ///< an open border, or one face is free and the other is blocked
};

/// A surface of convex faces in space, on which particles move.
class Surface {
 public:
  /// Takes the mesh as check_and_repair_surface() repairs it. Throws InvalidMesh, with the first faces, if that
  /// finds a defect. Cost: n log n.
  explicit Surface(MeshData mesh);

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }
  /// Positions of all points of the mesh, in its order, then positions of the points that edits made (SurfaceEdit).
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }

  /// Sets new positions of all points, and carries the particles. Numbers that edits gave up can have any position.
  /// Throws InvalidArgument if the number does not match, or a position is not finite or outside the exact range.
  /// Throws InvalidMesh, which names the faces by their numbers in the mesh, if a face would have a triangle without
  /// area. Then nothing is changed. Cost: linear.
  void move(std::span<const Vec3> positions, Threads threads = {});

  /// Frees or blocks a face, at once. Particles in a blocked face are held, and its edges to free faces are walls.
  /// Throws InvalidArgument if there is no such face.
  void set_free(Cell face, bool free);

  /// All triangles, face by face.
  [[nodiscard]] std::vector<SimplexId> triangles() const;
  /// The corners, counterclockwise as seen from the side that normals point to.
  [[nodiscard]] std::array<Vertex, 3> vertices(SimplexId t) const;
  [[nodiscard]] std::array<Vec3, 3> corners(SimplexId t) const;
  /// The other side of an edge of a triangle. Precondition: there is such an edge.
  [[nodiscard]] AcrossEdge across(SimplexId t, unsigned edge) const;
  /// Unit normal of a triangle.
  [[nodiscard]] Vec3 normal(SimplexId t) const;

  /// Whether a place is one of this surface: the triangle exists, and the weights are in [0, 1] and sum to 1 up to
  /// rounding.
  [[nodiscard]] bool contains(const SurfacePlace& place) const;
  /// The point in space, rounded. A place on an edge is the same point from both sides. A place at a vertex is the
  /// vertex's position.
  [[nodiscard]] Vec3 point(const SurfacePlace& place) const;
  /// A place from any weights that are finite, not negative and not all 0. The weights are scaled to sum to 1. Throws
  /// InvalidArgument if they are not such weights, or if there is no such triangle.
  [[nodiscard]] SurfacePlace place(SimplexId triangle, const std::array<double, 3>& weights) const;

 private:
  friend class SurfaceEdit;

  [[nodiscard]] bool has_flat_triangle(Cell c, std::span<const Vec3> positions) const;

  CombinatorialMap map_;
  std::vector<Vec3> positions_;
};

// The search for the place of a surface that is nearest to a point.

/// The place of a surface that is nearest to a point.
struct SurfaceLocation {
  SurfacePlace place;
  double distance = 0.0;
};

/// A tree over the triangles of a surface at one instant. Make it again after a move. Cost to make: n log n.
class SurfaceLocator {
 public:
  explicit SurfaceLocator(const Surface& surface);

  /// The nearest place, rounded, in free and blocked faces alike. If several places have equal distances, as doubles,
  /// it is that in the lowest-numbered face of the mesh and its first triangle. Throws InvalidArgument if x is not
  /// finite or outside the exact range. Precondition: the surface is that for which the tree was made, not moved since.
  /// Cost: the triangles with boxes nearer than about twice the distance, times a logarithm.
  [[nodiscard]] SurfaceLocation nearest(const Surface& surface, const Vec3& x) const;

 private:
  struct Tree;

  std::shared_ptr<const Tree> tree_;  // shared by copies
};

/// The place of a triangle that is nearest to x, by the regions of its corners, edges and inside. This work is based on
/// C. Ericson, "Real-time collision detection", 2005, section 5.1.5.
SurfaceLocation nearest_in_triangle(const Surface& surface, SimplexId triangle, const Vec3& x);

// Contacts on a surface, and responses to them.

/// A contact with a wall of a surface: an open border, or the border of a blocked face. Vectors are in the plane of the
/// triangle that `place` names, which is that of the particle.
struct SurfaceContact {
  std::uint32_t particle = 0;
  Kind kind = Kind::edge;       ///< edge or vertex
  Dart dart;                    ///< dart of the wall's edge, or from that vertex, in the free face
  Patch patch;                  ///< patch of the edge; at a vertex none
  double time_of_impact = 0.0;  ///< fraction of the step, in [0, 1]
  SurfacePlace place;
  Vec3 point;
  /// Unit vector within the surface, into the free side. At a vertex it halves the angle between the two walls that
  /// meet there.
  Vec3 normal;
  std::array<Vec3, 2> sides;  ///< unit vectors along the wall, away from the point: right (seen along the normal), left
  Vec3 displacement;          ///< the motion that led here, from its start in this step
  Vec3 unused;                ///< the remaining part of it
};

/// The motion of a particle after a contact, in the rest of the step.
struct AfterSurfaceContact {
  Vec3 displacement;   ///< in the plane of the contact's triangle; a normal part is ignored
  bool along = false;  ///< run along the wall exactly, if it points into the wall or off it only because of rounding
};

/// Decides what follows a contact. It is called from several threads at once for different particles. An empty function
/// stops the particle at the wall until the end of the step.
using SurfaceContactCallback = std::function<AfterSurfaceContact(const SurfaceContact&)>;

// For your own responses: the change of a vector at the wall. A vector that points off the wall stays as it is.

/// Rebound, with the share `restitution` of the part that is normal to the wall.
Vec3 reflected(const SurfaceContact& contact, const Vec3& v, double restitution = 1.0);

/// The part that runs along the wall. In a corner that closes both ways it is zero.
Vec3 slid(const SurfaceContact& contact, const Vec3& v);

// One step of a particle within a surface: straight lines that unfold across edges.
//
// Paths are straight at vertices, too: K. Polthier, M. Schmies, "Straightest geodesics on polyhedral surfaces", 1998.
// The path leaves a vertex so that the angles on its left and on its right are equal.

/// Limits of one step on a surface.
struct SurfaceOptions {
  /// Largest number of contacts of a particle in one step, at least 1. At the last one the particle stops.
  unsigned max_contacts = 16;
  /// Largest number of edges and vertices passed in one step. It bounds the time of a step, whatever rounding does and
  /// however long the step is. A straight path turns around a vertex by less than pi, so in practice only the number of
  /// triangles along the path counts.
  std::uint32_t max_crossings = 1U << 20U;
};

/// How the step of one particle ended.
enum class SurfaceEnd : std::uint8_t {
  arrived,  ///< at its target
  stopped,  ///< at a contact
  limit,    ///< after max_crossings
  held      ///< its face is blocked
};

/// The step of one particle.
struct SurfaceStep {
  SurfaceEnd end = SurfaceEnd::arrived;
  std::uint32_t contacts = 0;
  std::uint32_t crossings = 0;  ///< edges (those within polygons, too) and vertices passed
  double length = 0.0;          ///< length of the path so far
  /// Unit vector in the plane of the place's triangle: the last direction of motion, in which the particle can
  /// continue. Zero if the particle has not moved. On an edge or at a vertex it may point out of the triangle; a step
  /// along it continues straight.
  Vec3 direction;
  Vec3 remaining;  ///< the remaining displacement, in the same plane
};

/// An edge or a vertex passed.
struct SurfaceCrossing {
  double time = 0.0;  ///< fraction of the step, in [0, 1]
  Vec3 point;
  Kind kind = Kind::edge;
  Dart dart;           ///< dart of that edge or from that vertex, in the face behind; invalid within a polygon
  SurfacePlace place;  ///< in the triangle behind
};

/// The lists to which a step adds its contacts and crossings. Null: it adds none.
struct SurfaceTrace {
  std::vector<SurfaceContact>* contacts = nullptr;
  std::vector<SurfaceCrossing>* crossings = nullptr;
};

/// Moves a place by a displacement in the plane of its triangle. A part that is normal to that plane is ignored. The
/// place moves by the whole length, around corners and over edges, unless walls stop it. The error of the path is some
/// units in the last place for each triangle passed.
///
/// From an edge the displacement may point to either side, as if the triangle across were unfolded into that plane.
/// From a vertex it is an angle around the vertex. If it points away from the triangle, the path goes straight through
/// the vertex. Otherwise the angle is counted from the triangle's corner around the vertex on the shorter side.
///
/// The place always ends in a free face of the surface: by construction a ray leaves a triangle by an edge or a corner
/// (surface/unfold.hpp). A step of zero length has no contact. A step that ends exactly on a wall has a contact at time
/// 1.
///
/// Throws InvalidArgument, the place unchanged, if it is not one of this surface or max_contacts is 0. It also throws
/// if a displacement is not finite or above 2^300.
SurfaceStep step(const Surface& surface, SurfacePlace& place, const Vec3& displacement,
                 const SurfaceContactCallback& respond = {}, const SurfaceOptions& options = {},
                 const SurfaceTrace& trace = {}, std::uint32_t particle = 0);

/// A tangent vector at a corner of the triangle. `angle` is counterclockwise from the edge that starts at that corner.
Vec3 tangent(const Surface& surface, SimplexId triangle, unsigned corner, double angle, double length = 1.0);

// Many particles on a surface at once.

/// The effects of a step of all particles.
struct SurfaceReport {
  std::vector<SurfaceStep> steps;        ///< one per particle
  std::vector<SurfaceContact> contacts;  ///< by particle, then by time
};

/// Steps every place by its displacement, as step() does. Results are the same bits for any number of threads. Throws
/// as step(), which names the particle, and passes on exceptions of a response. Then no place is changed.
SurfaceReport advance(const Surface& surface, std::span<SurfacePlace> places, std::span<const Vec3> displacements,
                      const SurfaceContactCallback& respond = {}, const SurfaceOptions& options = {},
                      Threads threads = {});

// Edits of a surface: the edits of the plane (dartcast/map_edits.hpp), with positions. All or nothing.

/// A triangle of a face that an edit replaced, as it was.
struct GoneTriangle {
  SimplexId triangle;
  std::uint32_t source = 0;  ///< number of the face in the mesh
  std::array<Vec3, 3> corners;
};

/// The faces that an edit made and replaced.
struct SurfaceEditReport {
  EditReport map;
  std::vector<GoneTriangle> gone;  ///< sorted by triangle
};

/// A sequence of edits: split_edge(), split_face(), merge_faces(), merge_edges(), sew(), unsew(), remove(), and
/// set_free() of the transaction. If it ends without a commit, everything is undone. While it is open, no other code
/// may edit, move or copy the surface. Cost: that of the faces touched.
class SurfaceEdit {
 public:
  explicit SurfaceEdit(Surface& surface);
  SurfaceEdit(const SurfaceEdit&) = delete;
  SurfaceEdit& operator=(const SurfaceEdit&) = delete;
  SurfaceEdit(SurfaceEdit&&) = delete;
  SurfaceEdit& operator=(SurfaceEdit&&) = delete;
  ~SurfaceEdit();

  [[nodiscard]] Transaction& topology() { return transaction_; }
  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }
  /// The position of a vertex. A vertex that was put on an edge lies in its middle until it is placed. A vertex that
  /// was made by opening an edge lies where the old one lies. If two vertices were sewn to each other, the
  /// lower-numbered one keeps its position. Throws InvalidArgument if there is no such vertex.
  [[nodiscard]] Vec3 position(Vertex v);
  /// Places a vertex that this edit made. Throws InvalidArgument if this edit made no such vertex, or x is not
  /// finite or outside the exact range.
  void place(Vertex v, const Vec3& x);

  /// Makes everything final. Afterwards every place must follow the edit (followed()), and moves give positions of the
  /// new vertices, too. Throws EditRefused, everything undone, if a new face has a triangle without area. A face
  /// with a vertex on its edge has such a triangle, unless it is split there in the same edit.
  SurfaceEditReport commit();

 private:
  struct Created;  // the positions of new vertices

  Surface& surface_;
  Transaction transaction_;
  std::unique_ptr<Created> created_;
};

/// A place after an edit. If its face was not replaced, it stays as it is. A new face that comes from its face (by
/// source) may have a triangle with the same corners. The place then goes there with the same weights. Otherwise it
/// goes to the nearest place in the new faces. At equal distances a face that comes from its own is preferred, then the
/// first. So a place on an edge that is opened stays on its side.
///
/// Returns nothing if no face took the place of the removed ones. Every place must follow each edit before the next.
/// Cost: linear in the new faces.
std::optional<SurfacePlace> followed(const Surface& surface, const SurfaceEditReport& report,
                                     const SurfacePlace& place);

}  // namespace dartcast
