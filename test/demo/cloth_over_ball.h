// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_DEMO_CLOTH_OVER_BALL_H
#define FCL_CCD_DEMO_CLOTH_OVER_BALL_H

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "contact_response.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/stage_counts.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

/// @brief What happened in a frame. Its contacts are those of the motions that the steps
/// proposed, before anything answered them.
struct DemoFrame {
  int number{0};  // from 1
  /// each pair of features once
  std::vector<ContinuousContact<double>> contacts;
  std::size_t vertex_face{0};
  std::size_t edge_edge{0};
  /// contacts of both kinds between two places of the cloth
  std::size_t self{0};
  /// the first contact, as a fraction of the frame in [0, 1); 1 without contact
  double first_contact{1};
  /// stages of the queries of proposed motions, and the seconds of these queries
  StageCounts counts;
  double query_seconds{0};
  /// queries of the responses, and the seconds of whole responses
  int queries{0};
  double response_seconds{0};
  double total_seconds{0};
  /// vertices that moved in rigid zones, and those of zones that stood still, summed over
  /// the steps
  std::size_t in_zones{0};
  std::size_t stopped{0};
  /// steps in which the ball stood still
  int stopped_steps{0};
  /// contacts of the motions that were accepted
  std::size_t unresolved{0};
  /// whether a step began with surfaces that cross
  bool crossing{false};
};

/// @brief A square cloth of 1.5 m falls over a ball of 0.25 m radius that stands on the
/// ground. From 0.3 s on the ball spins faster and faster. The cloth winds itself around
/// it, slides over the ground, and folds.
///
/// The cloth moves by position based dynamics, after Mueller et al. 2007 "Position Based
/// Dynamics" and Macklin et al. 2016 "XPBD". contact_response.h answers its contacts.
/// Units are metres, seconds and kilograms.
class ClothOverBall {
 public:
  enum Body { kCloth, kBall, kGround };
  static constexpr int kStepsPerFrame = 8;

  /// @param resolution  the cloth has 2 resolution^2 triangles
  explicit ClothOverBall(int resolution);

  DemoFrame advanceFrame();

  /// @brief Cloth, ball and ground, at the current time.
  const TestMesh& mesh() const { return mesh_; }
  Body bodyOf(std::size_t vertex) const;

  /// @brief Whether surfaces cross at the current time, by an exact test.
  bool hasCrossing();

  /// @brief The number of frames so far, and their time.
  int frame() const { return step_ / kStepsPerFrame; }
  double time() const { return step_ * kStepTime; }

  /// @brief All that the next frames depend on, as bytes of this machine. A scene of the
  /// same resolution that takes them goes on with the same bits.
  std::string state() const;
  /// @throws std::runtime_error  the bytes are not those of such a scene
  void setState(const std::string& bytes);

 private:
  static constexpr double kFrameTime = 1. / 30;
  static constexpr double kStepTime = kFrameTime / kStepsPerFrame;
  struct Spring {
    std::array<std::size_t, 2> vertices;
    double rest_length;
    double softness;    // compliance over the square of the time of a step
    double multiplier;  // of the current step
  };
  using Positions = contact_response::Positions;

  void addSprings(const TestMesh& rest);
  void place(Positions& vertices, double ball_time) const;
  Positions proposed();
  void advanceStep(int step_of_frame, DemoFrame& frame);
  ContinuousContactResult<double> contactsOnTheWayTo(const Positions& next);
  void ask(const Positions& next, int step_of_frame, DemoFrame& frame);
  void damp();
  double ballTime(int step) const { return (step - stopped_steps_) * kStepTime; }

  TestMesh mesh_;
  TestMesh ball_;  // about its centre
  std::size_t first_of_ball_{0}, first_of_ground_{0};
  double mass_{0};  // of a vertex of the cloth
  Positions velocities_;
  std::vector<double> inverse_masses_;
  std::vector<Spring> springs_;
  contact_response::Options options_{};
  contact_response::Memory memory_;
  DeformableBVHModel<> model_;
  int step_{0};
  int stopped_steps_{0};
};

}  // namespace test
}  // namespace fcl

#endif
