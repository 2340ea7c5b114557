// SPDX-License-Identifier: BSD-3-Clause
//
// Position based dynamics for scenes of cloth, solids and moving obstacles, after Mueller
// et al. 2007 "Position Based Dynamics" and Macklin et al. 2016 "XPBD". A contact is
// found by the library's continuous query on the motion of the step; it becomes a
// constraint that keeps its two features apart. Departures that keep every state free of
// crossings:
// - the query is repeated on the corrected motion until it finds nothing;
// - what is still in contact after that moves with the obstacle it touches, or not at all
//   (the rigid impact zones of Provot 1997, with the simplest rigid motion);
// - if that does not help, because obstacles crush what is between them, these stop for
//   the step, what is around a contact is held with it, and in the end everything.
#ifndef FCL_TEST_SUPPORT_CLOTH_SIMULATOR_H
#define FCL_TEST_SUPPORT_CLOTH_SIMULATOR_H

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "affine_body.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fragile_shell.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

/// @brief Units are metres, seconds and kilograms.
struct SimulatorOptions {
  /// seconds a frame lasts
  double frame_time{1.0 / 30};
  /// steps a frame is divided into; each has its own continuous queries
  int steps_per_frame{8};
  /// passes over all constraints in a step
  int iterations{25};
  Vector3<double> gravity{0, 0, -9.81};
  /// distance that surfaces keep, metres
  double thickness{0.002};
  /// speed at which surfaces closer than `thickness` are pushed apart, metres a second
  double push_speed{0.05};
  /// part of their distance by which surfaces in contact may approach each other in a
  /// step, down to a tenth of `thickness`: what is wedged in between others has a motion
  /// that satisfies all of them then, and is not held
  double approach{0};
  /// Coulomb coefficient
  double friction{0.3};
  /// part of the velocity lost in a second (exponential), 1 / s
  double damping{0.5};
  /// part of the velocity of two neighbours against each other lost in a second
  /// (exponential), 1 / s; calms what contacts and springs do to each other
  double internal_damping{100};
  /// the same for the deformation of solids, 1 / s
  double solid_damping{4};
  /// kilograms a square metre of cloth
  double cloth_density{0.2};
  /// XPBD compliance of the bending springs, metres a newton
  double bend_compliance{0.5};
  /// rounds of query and correction in a step before what is in contact is slowed down
  int response_rounds{4};
  /// rounds after those in which it goes half as far, before it is held
  int slowing_rounds{3};
  /// most contacts of the same two solids in a query that become constraints, spread over
  /// all. The motions of two solids have no more than 24 unknowns, but where they overlap
  /// many thousands of contacts
  int contacts_per_pair{std::numeric_limits<int>::max()};
  /// whether surfaces that are near each other are pushed apart (see `thickness`) before
  /// they touch; without, only contacts are answered, which is cheaper
  bool push_apart{true};
  /// whether a report lists the contacts of all queries, of which there can be millions
  bool keep_contacts{true};
  /// whether freeMotion() is wanted
  bool find_free_motion{false};
  /// of the queries; what results does not depend on it
  int num_threads{1};
  /// shakes the start positions by 1e-4 of an edge and orders the constraints
  std::uint64_t seed{1};
};

/// @brief What a solid is made of.
struct SolidOptions {
  /// kilograms a square metre of its surface
  double density{5};
  /// radians a second in which a deformed solid swings back to its shape; infinite: rigid
  double frequency{std::numeric_limits<double>::infinity()};
  /// metres a second, at the start
  Vector3<double> velocity{Vector3<double>::Zero()};
};

/// @brief When a fragile solid breaks.
struct FragileOptions {
  /// mean of the impulses that a bond endures in a step, N s; each bond's own is between
  /// half and one and a half of it
  double strength{1};
  /// distance from a blow at which it loads a bond with 1 / e of itself, metres
  double reach{0.1};
  /// how far borders of parted pieces draw back, in lengths of their edges
  double gap{0.02};
  /// speed at which parts leave the middle of the shell, metres a second; a random part
  /// of it is missing
  double burst{0};
};

/// @brief Where two features touched, as weights on their four vertices: positive ones
/// add up to 1 on the first feature, negative ones to -1 on the second.
struct ContactWeights {
  std::array<int, 4> vertices;
  std::array<double, 4> weights;
};

/// @brief A distinct pair of features that a query of the frame found.
struct FrameContact {
  ContinuousContactKind kind;
  std::array<int, 2> triangles;
  ContactWeights where;
};

/// @brief What happened in one frame.
struct FrameReport {
  std::vector<FrameContact> contacts;
  std::size_t vertex_face{0};
  std::size_t edge_edge{0};
  /// those of both kinds between two features of one body
  std::size_t self{0};
  /// the first contact, as a fraction of the frame in [0, 1); 1 without contact
  double first_contact{1};
  /// number of continuous queries, and the seconds they and the whole frame took
  int queries{0};
  double query_seconds{0};
  double total_seconds{0};
  /// sum over the queries
  StageCounts counts;
  /// vertices that had to be held, summed over the steps
  std::size_t held_vertices{0};
  /// contacts still there when a step was accepted
  std::size_t unresolved{0};
  /// steps in which obstacles had to stop
  int stopped_steps{0};
  /// whether a step began with surfaces that cross
  bool crossing{false};
};

/// @brief Rigid motion of an obstacle: its pose at a time in seconds.
using ObstacleMotion = std::function<Transform3<double>(double time)>;

/// @brief Cloths and obstacles as one mesh, so that one self-collision query sees
/// cloth-cloth and cloth-obstacle contacts alike. A run is a function of what was added
/// and of the options: same seed, same bits.
class ClothSimulator {
 public:
  explicit ClothSimulator(const SimulatorOptions& options)
      : options_(options), random_(options.seed + 1) {}

  /// @brief Adds a cloth at rest in the shape of `rest`, that starts in the shape of
  /// `start` (same topology). @return its first vertex
  int addCloth(const TestMesh& rest, const std::vector<Vector3<double>>& start);

  /// @brief Adds an obstacle, given in its own frame. Without motion it stands still.
  /// @return its first vertex
  int addObstacle(const TestMesh& mesh, ObstacleMotion motion = {});

  /// @brief Lets a vertex of a cloth move with an obstacle.
  void pin(int vertex, int obstacle);

  /// @brief Adds a solid where the mesh is. @return its first vertex
  int addSolid(const TestMesh& mesh, const SolidOptions& options);

  /// @brief Adds a solid that breaks into its pieces. @return its first vertex
  int addFragile(const ShellDesign& design, const SolidOptions& options,
                 const FragileOptions& fragile);

  /// @brief Breaks what the frame before loaded too much, then simulates one frame. The
  /// first call ends the construction.
  /// @throws fcl::Exception if the library refuses the mesh, for example because a
  /// coordinate is not finite.
  FrameReport advanceFrame();

  /// @brief All bodies in the order in which they were added, at the current time.
  const TestMesh& mesh() const { return mesh_; }

  /// @brief Where the last frame's motion began, vertices as in mesh().
  const std::vector<Vector3<double>>& frameBegin() const { return frame_begin_; }

  /// @brief Where the last frame would have led if nothing were in the way: what a
  /// simulator with one step a frame asks collision detection about.
  const std::vector<Vector3<double>>& freeMotion() const { return free_motion_; }

  /// @brief How the mesh changed at the beginning of the last frame.
  const TopologyChange& topologyChange() const { return change_; }

  /// @brief The body of a vertex: 0, 1, ... in the order in which they were added.
  int bodyOf(std::size_t vertex) const { return body_of_[vertex]; }

  /// @brief bodyOf() of all vertices.
  const std::vector<int>& bodies() const { return body_of_; }

  /// @brief The options given.
  const SimulatorOptions& options() const { return options_; }

  /// @brief Seconds simulated.
  double time() const {
    return static_cast<double>(step_) * options_.frame_time / options_.steps_per_frame;
  }

  /// @brief Largest current length of a cloth edge over its length at rest.
  double maxStretch() const;

 private:
  struct Spring {
    std::array<int, 2> vertices;
    double rest_length;  // metres
    double compliance;   // metres a newton
    double multiplier;   // of the current step
  };
  /// The part of a separation that a solid has: weight * centre + shape * rest.
  struct SolidShare {
    int solid{-1};
    double weight{0};
    Vector3<double> rest{Vector3<double>::Zero()};
  };
  struct ContactConstraint {
    ContactWeights where;  // without the vertices of solids
    std::array<SolidShare, 2> solids;
    Vector3<double> direction;  // from the second feature to the first, unit
    Vector3<double> begin;      // separation at the start of the step
    double gap;                 // metres
    double impulse;             // of the step, kg m
  };
  struct Solid {
    AffineBody body;
    int shell{-1};  // the fragile shell that it is a part of
    int pieces{0};  // of the shell
    Vector3<double> offset{Vector3<double>::Zero()};  // from rest to the shell's design
  };
  struct Shell {
    FragileShell surface;
    FragileOptions options;
    double vertex_mass;      // kg
    Vector3<double> middle;  // of the design
    std::vector<int> solid_of_piece;
    bool is_loaded;  // bonds broke since its surface was parted
  };
  enum class Kind { kCloth, kObstacle, kSolid };
  struct Body {
    int first_vertex;
    int num_vertices;
    Kind kind;
    TestMesh shape;
    ObstacleMotion motion;
    Transform3<double> step_motion;  // the identity unless it is an obstacle that moves
  };

  double stepTime() const { return step_time_; }
  int addBody(const TestMesh& mesh, Kind kind, ObstacleMotion motion);
  void addSprings(const TestMesh& rest, int first_vertex);
  void addMasses(const TestMesh& rest, int first_vertex);
  Solid makeSolid(const std::vector<int>& vertices,
                  const std::vector<Vector3<double>>& places, double vertex_mass,
                  const SolidOptions& options);
  void start();
  void buildModel();
  void breakShells();
  void divideSolids(int shell, const std::vector<int>& part_of_piece,
                    const std::vector<Vector3<double>>& design);
  void loadBonds();

  double obstacleTime() const {
    return static_cast<double>(step_ - stopped_steps_) * options_.frame_time /
           options_.steps_per_frame;
  }
  bool isObstacle(int body) const {
    return bodies_[static_cast<std::size_t>(body)].kind == Kind::kObstacle;
  }

  void findFreeMotion();
  void finishContacts(FrameReport& report) const;
  void advanceStep(int step_of_frame, FrameReport& report);
  void predict();
  void placeSolids();
  void pushApart();
  void solve(int iterations);
  void projectSpring(Spring& spring);
  Vector3<double> separationNow(const ContactConstraint& contact) const;
  void projectContact(ContactConstraint& contact);
  void projectContacts();
  void respond(int step_of_frame, FrameReport& report);
  void holdInContact(int step_of_frame, FrameReport& report);
  std::size_t holdContacts(const std::vector<ContinuousContact<double>>& contacts,
                           bool with_neighbours);
  void slowDown(const std::vector<ContinuousContact<double>>& contacts);
  int carrierOf(const ContinuousContact<double>& contact) const;
  int carrierOf(int vertex) const;
  bool hold(int vertex, int carrier);
  void stopObstacles();
  void stopAll();
  void finishStep();
  void dampNeighbours();

  ContinuousContactResult<double> query(int step_of_frame, FrameReport& report);
  ContactWeights weightsAt(const ContinuousContact<double>& contact) const;
  void addConstraints(const std::vector<ContinuousContact<double>>& contacts);
  void addConstraint(ContinuousContactKind kind, ContactWeights where,
                     Vector3<double> direction);

  SimulatorOptions options_;
  Random random_;                       // of what breaks
  TestMesh mesh_;                       // positions at the start of the step
  std::vector<Vector3<double>> moved_;  // positions at the end of the step
  std::vector<Vector3<double>> velocities_;
  std::vector<double> inverse_masses_;  // 0 for obstacles
  std::vector<char> is_movable_;
  std::vector<int> body_of_;
  std::vector<Body> bodies_;
  std::vector<Spring> edge_springs_;
  std::vector<Spring> bend_springs_;
  std::vector<ContactConstraint> contacts_;
  std::vector<int> held_with_;         // body a held vertex moves with, or -1
  std::vector<int> pinned_to_;         // obstacle, or -1
  std::vector<int> solid_of_;          // solid, or -1
  std::vector<Vector3<double>> rest_;  // of the vertices of solids
  std::vector<Solid> solids_;
  std::vector<Shell> shells_;
  std::vector<Vector3<double>> frame_begin_;
  std::vector<Vector3<double>> free_motion_;
  TopologyChange change_;
  double mean_edge_{0};
  double step_time_{0};
  /// Speed of the fastest thing when the step begins, and what gravity adds. Contacts
  /// pass motion on and make none: pushes, each of them right, may not add up to more.
  double fastest_{0};
  std::int64_t step_{0};
  std::int64_t stopped_steps_{0};
  bool started_{false};
  DeformableBVHModel<KDOP<double, 16>> model_;
};

}  // namespace test
}  // namespace fcl

#endif
