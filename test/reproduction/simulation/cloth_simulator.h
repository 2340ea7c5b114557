// SPDX-License-Identifier: BSD-3-Clause
//
// Position based dynamics for scenes of cloth, solids and moving obstacles, after Mueller
// et al. 2007 "Position Based Dynamics" and Macklin et al. 2016 "XPBD". The library's
// continuous query finds the contacts in the motion of the step. A contact becomes a
// constraint that keeps its two features apart. Some rules differ, to keep every state
// free of crossings:
// - the query is repeated on the corrected motion until it finds nothing;
// - features that are still in contact after that move with the obstacle they touch, or
//   not at all (the rigid impact zones of Provot 1997, with the simplest rigid motion);
// - if that does not help, because obstacles crush what is between them, the obstacles
//   stop for the step, the surroundings of a contact are held with it, and in the end
//   everything is held.
#ifndef FCL_TEST_REPRODUCTION_CLOTH_SIMULATOR_H
#define FCL_TEST_REPRODUCTION_CLOTH_SIMULATOR_H

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
  /// length of a frame in seconds
  double frame_time{1.0 / 30};
  /// number of steps in a frame; each has its own continuous queries
  int steps_per_frame{8};
  /// number of passes over all constraints in a step
  int iterations{25};
  Vector3<double> gravity{0, 0, -9.81};
  /// distance that surfaces keep, in metres
  double thickness{0.002};
  /// speed at which surfaces closer than `thickness` are pushed apart, in metres per
  /// second
  double push_speed{0.05};
  /// fraction of their distance by which surfaces in contact may approach each other in a
  /// step, down to a tenth of `thickness`. Bodies that are wedged between others then
  /// have a motion that satisfies all of their constraints, and are not held
  double approach{0};
  /// Coulomb coefficient
  double friction{0.3};
  /// fraction of the velocity that is lost per second (exponential), 1 / s
  double damping{0.5};
  /// fraction of the relative velocity of two neighbours that is lost per second
  /// (exponential), 1 / s; it damps the effect of contacts and springs
  double internal_damping{100};
  /// the same for the deformation of solids, 1 / s
  double solid_damping{4};
  /// mass of cloth in kilograms per square metre
  double cloth_density{0.2};
  /// XPBD compliance of the bending springs, in metres per newton
  double bend_compliance{0.5};
  /// rounds of query and correction in a step, before features that are still in contact
  /// are slowed down
  int response_rounds{4};
  /// rounds after those in which they go half as far, before they are held
  int slowing_rounds{3};
  /// largest number of contacts of the same two solids in a query that become
  /// constraints; they are spread over all contacts. The motions of two solids have no
  /// more than 24 unknowns, but they may overlap in many thousands of contacts
  int contacts_per_pair{std::numeric_limits<int>::max()};
  /// whether surfaces that are near each other are pushed apart (see `thickness`) before
  /// they touch; if not, only contacts get a response, which costs less
  bool push_apart{true};
  /// whether a report lists the contacts of all queries; there can be millions
  bool keep_contacts{true};
  /// whether freeMotion() is needed
  bool find_free_motion{false};
  /// threads of the queries; the result does not depend on it
  int num_threads{1};
  /// seed of the shaking of start positions, by 1e-4 of an edge, and of the order of
  /// constraints
  std::uint64_t seed{1};
};

/// @brief The material of a solid.
struct SolidOptions {
  /// mass in kilograms per square metre of its surface
  double density{5};
  /// angular frequency with which a deformed solid swings back to its shape, in radians
  /// per second; infinite: rigid
  double frequency{std::numeric_limits<double>::infinity()};
  /// velocity at the start, in metres per second
  Vector3<double> velocity{Vector3<double>::Zero()};
};

/// @brief When a fragile solid breaks.
struct FragileOptions {
  /// mean of the impulses that bonds endure in a step, N s; each bond's own is between
  /// half and one and a half of it
  double strength{1};
  /// distance from a blow at which it loads a bond with 1 / e of itself, in metres
  double reach{0.1};
  /// distance by which the borders of separated pieces move back, in lengths of their
  /// edges
  double gap{0.02};
  /// speed at which parts leave the middle of the shell, in metres per second; it is
  /// reduced by a random fraction
  double burst{0};
};

/// @brief The place where two features touched, as weights on their four vertices.
/// Positive weights add up to 1 on the first feature, negative ones to -1 on the second.
struct ContactWeights {
  std::array<int, 4> vertices;
  std::array<double, 4> weights;
};

/// @brief A feature pair that a query of the frame found, listed once.
struct FrameContact {
  ContinuousContactKind kind;
  std::array<int, 2> triangles;
  ContactWeights where;
};

/// @brief The report of one frame.
struct FrameReport {
  std::vector<FrameContact> contacts;
  std::size_t vertex_face{0};
  std::size_t edge_edge{0};
  /// contacts of both kinds between two features of one body
  std::size_t self{0};
  /// the first contact, as a fraction of the frame in [0, 1); 1 without contact
  double first_contact{1};
  /// number of continuous queries, and the seconds that they and the whole frame took
  int queries{0};
  double query_seconds{0};
  double total_seconds{0};
  /// sum over the queries
  StageCounts counts;
  /// number of held vertices, summed over the steps
  std::size_t held_vertices{0};
  /// number of contacts that were left when a step was accepted
  std::size_t unresolved{0};
  /// number of steps in which obstacles had to stop
  int stopped_steps{0};
  /// whether a step began with surfaces that cross
  bool crossing{false};
};

/// @brief Rigid motion of an obstacle: its pose at a time in seconds.
using ObstacleMotion = std::function<Transform3<double>(double time)>;

/// @brief Cloths and obstacles as one mesh, so that one self-collision query finds
/// cloth-cloth and cloth-obstacle contacts. A run depends only on the added bodies and on
/// the options: the same seed gives the same bits.
class ClothSimulator {
 public:
  explicit ClothSimulator(const SimulatorOptions& options)
      : options_(options), random_(options.seed + 1) {}

  /// @brief Adds a cloth at rest in the shape of `rest`, that starts in the shape of
  /// `start` (same topology). @return its first vertex
  int addCloth(const TestMesh& rest, const std::vector<Vector3<double>>& start);

  /// @brief Adds an obstacle, given in its own coordinates. Without motion it stands
  /// still. @return its first vertex
  /// @return its first vertex
  int addObstacle(const TestMesh& mesh, ObstacleMotion motion = {});

  /// @brief Makes a vertex of a cloth move with an obstacle.
  void pin(int vertex, int obstacle);

  /// @brief Adds a solid at the position of the mesh. @return its first vertex
  int addSolid(const TestMesh& mesh, const SolidOptions& options);

  /// @brief Adds a solid that breaks into its pieces. @return its first vertex
  int addFragile(const ShellDesign& design, const SolidOptions& options,
                 const FragileOptions& fragile);

  /// @brief Breaks bonds that the previous frame overloaded, then simulates one frame.
  /// The first call ends the construction.
  /// @throws fcl::Exception if the library refuses the mesh, for example because a
  /// coordinate is not finite.
  FrameReport advanceFrame();

  /// @brief All bodies in the order in which they were added, at the current time.
  const TestMesh& mesh() const { return mesh_; }

  /// @brief The positions where the last frame's motion began, vertices as in mesh().
  const std::vector<Vector3<double>>& frameBegin() const { return frame_begin_; }

  /// @brief The positions where the last step of the last frame began. From there to
  /// mesh() is a motion whose contacts were answered.
  const std::vector<Vector3<double>>& stepBegin() const { return moved_; }

  /// @brief The positions to which the last frame would have led if nothing were in the
  /// way. A simulator with one step a frame asks collision detection about this motion.
  const std::vector<Vector3<double>>& freeMotion() const { return free_motion_; }

  /// @brief The change of the mesh at the beginning of the last frame.
  const TopologyChange& topologyChange() const { return change_; }

  /// @brief The body of a vertex: 0, 1, ... in the order in which they were added.
  int bodyOf(std::size_t vertex) const { return body_of_[vertex]; }

  /// @brief bodyOf() of all vertices.
  const std::vector<int>& bodies() const { return body_of_; }

  /// @brief The options given.
  const SimulatorOptions& options() const { return options_; }

  /// @brief The simulated time in seconds.
  double time() const {
    return static_cast<double>(step_) * options_.frame_time / options_.steps_per_frame;
  }

  /// @brief The largest ratio of a cloth edge's current length to its length at rest.
  double maxStretch() const;

 private:
  struct Spring {
    std::array<int, 2> vertices;
    double rest_length;  // metres
    double compliance;   // metres a newton
    double multiplier;   // of the current step
  };
  /// The part of a separation that comes from a solid: weight * centre + shape * rest.
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
    bool is_loaded;  // bonds broke since its surface was split
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
  std::vector<Vector3<double>> moved_;  // positions at its end; after it, at its start
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
  /// Speed of the fastest object at the beginning of the step, plus that of gravity.
  /// Contacts pass motion on and create none. But many pushes, each of them right, could
  /// add up to more.
  double fastest_{0};
  std::int64_t step_{0};
  std::int64_t stopped_steps_{0};
  bool started_{false};
  DeformableBVHModel<KDOP<double, 16>> model_;
};

}  // namespace test
}  // namespace fcl

#endif
