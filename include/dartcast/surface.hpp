// A surface in space: a map of polygons with positions. Particles move within it.
//
// A polygon is fanned from its lowest-numbered corner (dartcast/cell_shape.hpp); the triangles of the fans are the
// surface, so that it has no gaps however it is bent. Where a particle is is told within a triangle, by weights: there
// is no point beside the surface to fall off it.
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
/// of them is exactly 0, at a vertex two. It needs no update when the surface bends: what is on it rides along.
struct SurfacePlace {
  SimplexId triangle;
  std::array<double, 3> weights = {1.0, 0.0, 0.0};

  /// Inside of the triangle, on an edge, or at a vertex.
  [[nodiscard]] Kind kind() const {
    const int zeros = (weights[0] == 0.0 ? 1 : 0) + (weights[1] == 0.0 ? 1 : 0) + (weights[2] == 0.0 ? 1 : 0);
    return zeros == 0 ? Kind::face : zeros == 1 ? Kind::edge : Kind::vertex;
  }
  bool operator==(const SurfacePlace&) const = default;
};

/// What lies across an edge of a triangle; edge i is opposite to corner i.
struct AcrossEdge {
  CellFace face;       ///< the map's edge, of the cell left behind; invalid within a polygon
  SimplexId triangle;  ///< invalid at an open border
  unsigned edge = 0;   ///< of that triangle
  bool wall = false;   ///< an open border, or one face is free and the other is blocked
};

class Surface {
 public:
  /// Takes the mesh as check_and_repair_surface() repairs it. Throws InvalidMesh where that finds a defect, with the
  /// first faces. Cost: n log n.
  explicit Surface(MeshData mesh);

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }
  /// Positions of all points of the mesh, in its order, then of those that edits made (dartcast/surface.hpp).
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }

  /// New positions of all points (numbers that edits gave up can have any); particles ride along. Throws
  /// InvalidArgument, nothing changed, where their number does not match or one is not finite or out of the exact
  /// range, and InvalidMesh, nothing changed, with the faces (numbers in the mesh) that would have a triangle without
  /// area. Cost: linear.
  void move(std::span<const Vec3> positions, Threads threads = {});

  /// Frees or blocks a face, at once: particles in a blocked one are held, its edges to free ones are walls. Throws
  /// InvalidArgument where there is no such face.
  void set_free(Cell face, bool free);

  /// All triangles, face by face.
  [[nodiscard]] std::vector<SimplexId> triangles() const;
  /// Corners counterclockwise, seen from the side that normals point to.
  [[nodiscard]] std::array<Vertex, 3> vertices(SimplexId t) const;
  [[nodiscard]] std::array<Vec3, 3> corners(SimplexId t) const;
  [[nodiscard]] AcrossEdge across(SimplexId t, unsigned edge) const;
  /// Unit normal of a triangle.
  [[nodiscard]] Vec3 normal(SimplexId t) const;

  /// Whether a place can be one here: the triangle is there, weights are in [0, 1] and sum to 1 up to rounding.
  [[nodiscard]] bool contains(const SurfacePlace& place) const;
  /// The point in space, to rounding. One place of an edge is the same point from both sides; a vertex its position.
  [[nodiscard]] Vec3 point(const SurfacePlace& place) const;
  /// A place by any weights that are finite, not negative and not all 0, which are scaled to sum to 1. Throws
  /// InvalidArgument where they are not, or where there is no such triangle.
  [[nodiscard]] SurfacePlace place(SimplexId triangle, const std::array<double, 3>& weights) const;

 private:
  friend class SurfaceEdit;

  [[nodiscard]] bool has_flat_triangle(Cell c, std::span<const Vec3> positions) const;

  CombinatorialMap map_;
  std::vector<Vec3> positions_;
};

// The place of a surface that is nearest to a point.

struct SurfaceLocation {
  SurfacePlace place;
  double distance = 0.0;
};

/// A tree over the triangles of a surface at one instant: make it again after a move. Cost to make: n log n.
class SurfaceLocator {
 public:
  explicit SurfaceLocator(const Surface& surface);

  /// The nearest place, rounded; of places at equal distances, as doubles, that in the lowest-numbered face of the mesh
  /// and its first triangle. In free faces and blocked ones alike. Throws InvalidArgument where x is not finite or out
  /// of the exact range. Precondition: the surface that it was made for, unmoved. Cost: the triangles whose boxes come
  /// nearer than about twice the distance, times a logarithm.
  [[nodiscard]] SurfaceLocation nearest(const Surface& surface, const Vec3& x) const;

 private:
  struct Tree;

  std::shared_ptr<const Tree> tree_;  // shared by copies
};

/// The place of a triangle that is nearest to x, by the regions of its corners, edges and inside. This work is based on
/// C. Ericson, "Real-time collision detection", 2005, section 5.1.5.
SurfaceLocation nearest_in_triangle(const Surface& surface, SimplexId triangle, const Vec3& x);

// What a particle meets on a surface, and what it may do then.

/// A wall on a surface: an open border, or the border of a blocked face. Vectors are in the plane of the triangle that
/// the place names, that of the particle.
struct SurfaceContact {
  std::uint32_t particle = 0;
  Kind kind = Kind::edge;       ///< edge or vertex
  Dart dart;                    ///< of the wall's edge, or from that vertex; in the free face
  Patch patch;                  ///< of the edge; at a vertex none
  double time_of_impact = 0.0;  ///< fraction of the step, in [0, 1]
  SurfacePlace place;
  Vec3 point;
  /// Unit, within the surface, into the free side; at a vertex it halves the angle between the two walls that meet
  /// there.
  Vec3 normal;
  std::array<Vec3, 2>
      sides;          ///< unit, along the wall, away from the point: to the right as seen along the normal, left
  Vec3 displacement;  ///< the motion that led here, from the place where it began in this step
  Vec3 unused;        ///< what is left of it
};

/// What a particle does after a contact, in the rest of the step.
struct AfterSurfaceContact {
  Vec3 displacement;   ///< in the plane of the contact's triangle; what is normal to it is left out
  bool along = false;  ///< where it points into the wall, or off it by rounding alone, it runs along it exactly
};

/// Decides what follows a contact. Called from several threads at once for different particles; an empty function stops
/// the particle at the wall until the end of the step.
using SurfaceContactCallback = std::function<AfterSurfaceContact(const SurfaceContact&)>;

// For a caller's own responses: what becomes of a vector at the wall. They do nothing where it points off the wall.

/// Rebound, with the share `restitution` of what is normal to the wall.
Vec3 reflected(const SurfaceContact& contact, const Vec3& v, double restitution = 1.0);

/// What of it runs along the wall; in a corner that closes both ways, nothing.
Vec3 slid(const SurfaceContact& contact, const Vec3& v);

// One step of a particle within a surface: straight lines that unfold across edges.
//
// Straight at vertices, too: K. Polthier, M. Schmies, "Straightest geodesics on polyhedral surfaces", 1998: the path
// leaves a vertex so that the angles on its left and on its right are equal.

struct SurfaceOptions {
  /// Contacts allowed to a particle in one step, at least 1; at the last one it stops.
  unsigned max_contacts = 16;
  /// Edges and vertices passed in one step, at most. A straight path passes an edge once in a while: around a vertex it
  /// turns by less than pi, so that only the number of triangles along it counts. This bounds the time of a step
  /// whatever rounding does, and steps that are longer than meant.
  std::uint32_t max_crossings = 1U << 20U;
};

enum class SurfaceEnd : std::uint8_t {
  arrived,  ///< the whole way is done
  stopped,  ///< at a contact
  limit,    ///< after max_crossings
  held      ///< its face is blocked
};

struct SurfaceStep {
  SurfaceEnd end = SurfaceEnd::arrived;
  std::uint32_t contacts = 0;
  std::uint32_t crossings = 0;  ///< edges (those within polygons, too) and vertices passed
  double length = 0.0;          ///< of the way done
  /// Unit, in the plane of the place's triangle: the direction that it moved in last, to move on in; zero where it has
  /// not moved. On an edge or at a vertex it may point out of the triangle: a step along it goes straight on.
  Vec3 direction;
  Vec3 remaining;  ///< displacement left, likewise
};

/// An edge or a vertex passed.
struct SurfaceCrossing {
  double time = 0.0;  ///< fraction of the step, in [0, 1]
  Vec3 point;
  Kind kind = Kind::edge;
  Dart dart;           ///< of that edge or from that vertex, in the face left behind; invalid within a polygon
  SurfacePlace place;  ///< in the triangle left behind
};

/// Where to note what a step meets; null: nowhere.
struct SurfaceTrace {
  std::vector<SurfaceContact>* contacts = nullptr;
  std::vector<SurfaceCrossing>* crossings = nullptr;
};

/// Moves a place by a displacement in the plane of its triangle; what is normal to that plane is left out. From an edge
/// it may point to either side, as if the triangle across were unfolded into that plane; from a vertex it is an angle
/// around it: straight through the vertex where it points away from the triangle, else counted from the triangle's
/// corner around the vertex on the shorter side. It goes as far as it says, around corners and over edges, unless walls
/// stop it. Errors of the way: some units in the last place for each triangle passed.
///
/// The place ends on the surface in a free face whatever happens: a ray leaves a triangle by one of its edges or
/// corners, by construction (surface/unfold.hpp). A step of zero length meets nothing; one that ends exactly on a wall
/// meets it at time 1. Throws InvalidArgument, the place unchanged, where the place is none of this surface,
/// max_contacts is 0, or the displacement (or a response's) is not finite or above 2^300.
SurfaceStep step(const Surface& surface, SurfacePlace& place, const Vec3& displacement,
                 const SurfaceContactCallback& respond = {}, const SurfaceOptions& options = {},
                 const SurfaceTrace& trace = {}, std::uint32_t particle = 0);

/// The tangent of a length at an angle, counterclockwise from the edge that starts at a corner of the triangle.
Vec3 tangent(const Surface& surface, SimplexId triangle, unsigned corner, double angle, double length = 1.0);

// Many particles on a surface at once.

struct SurfaceReport {
  std::vector<SurfaceStep> steps;        ///< one per particle
  std::vector<SurfaceContact> contacts;  ///< by particle, then by time
};

/// Steps every place by its displacement, as step() does. Results are the same bits for any number of threads. Throws
/// as step(), naming the particle, and what a response throws: no place is changed then.
SurfaceReport advance(const Surface& surface, std::span<SurfacePlace> places, std::span<const Vec3> displacements,
                      const SurfaceContactCallback& respond = {}, const SurfaceOptions& options = {},
                      Threads threads = {});

// Edits of a surface: those of the plane (dartcast/map_edits.hpp), with positions. All or nothing.

/// A triangle of a face that an edit replaced, as it was.
struct GoneTriangle {
  SimplexId triangle;
  std::uint32_t source = 0;  ///< number of the face in the mesh
  std::array<Vec3, 3> corners;
};

struct SurfaceEditReport {
  EditReport map;
  std::vector<GoneTriangle> gone;  ///< sorted by triangle
};

/// A sequence of edits: split_edge(), split_face(), merge_faces(), merge_edges(), sew(), unsew(), remove(), and
/// set_free() of the transaction. What is not committed when it ends is taken back. While it is open, nobody else
/// edits, moves or copies the surface. Cost: that of the faces touched.
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
  /// Where a vertex is. One put on an edge lies in its middle until it is placed, one that was parted where the other
  /// does; of two that were sewn to each other the lower-numbered one stays where it is. Throws InvalidArgument where
  /// there is no such vertex.
  [[nodiscard]] Vec3 position(Vertex v);
  /// Places a vertex that this edit made. Throws InvalidArgument where it made no such vertex, or x is not finite or
  /// out of the exact range.
  void place(Vertex v, const Vec3& x);

  /// Makes everything final. Places in the faces replaced are to follow (followed()); moves give positions of the new
  /// vertices, too. Throws EditRefused, everything taken back, where a new face has a triangle without area: a face
  /// with a vertex on its edge has one, unless it is split there in the same edit.
  SurfaceEditReport commit();

 private:
  struct Created;  // the positions of new vertices

  Surface& surface_;
  Transaction transaction_;
  std::unique_ptr<Created> created_;
};

/// A place after an edit: as it was where its face was not replaced; in a triangle with the same corners, if one of the
/// new faces from its face (by source) has it, with the same weights; else the nearest place in the new faces, of
/// several at the same distance that in a face from its own, then the first. So what lies on an edge that is opened
/// stays on its side. Nothing where no face took the place of those removed. Every place must follow each edit before
/// the next. Cost: linear in the new faces.
std::optional<SurfacePlace> followed(const Surface& surface, const SurfaceEditReport& report,
                                     const SurfacePlace& place);

}  // namespace dartcast
