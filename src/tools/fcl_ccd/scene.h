// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENE_H
#define FCL_CCD_SCENE_H

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "fcl/narrowphase/continuous_contact.h"
#include "mesh_io.h"
#include "mesh_model.h"

namespace fcl_ccd {

struct StepSettings {
  fcl::ContinuousQuery query{fcl::ContinuousQuery::kAll};
  double toc_err{1e-4};
  bool self{true};     ///< whether A is tested against itself
  bool points{false};  ///< whether contacts have a position and a normal
  /// Whether all crossings are wanted. Otherwise one tells that there are some.
  bool all_crossings{false};
  double min_distance{0};
  bool ignore_initially_closer{false};
  int repeat{1};
  int num_threads{1};
};

/// @brief A vertex of one of the two meshes.
struct SceneVertex {
  int id{-1};
  bool of_b{false};
};

/// @brief A contact of the scene, or a crossing, with the data that the program reports.
struct SceneContact {
  fcl::ContinuousContactKind kind{fcl::ContinuousContactKind::kVertexFace};
  std::array<SceneVertex, 5> vertices;
  int num_vertices{4};
  double toc_lo{0};
  double toc_hi{0};
  /// The triangles of the first feature (vertex, or edge a) and of the second one; or the
  /// free edges or points, by their numbers in the order of the file.
  std::array<std::intptr_t, 2> triangles{{-1, -1}};
  std::array<fcl::PrimitiveKind, 2> triangle_kinds{};
  /// Position at toc_lo; only with StepSettings::points.
  std::array<double, 3> position{};
  std::array<double, 3> normal{};  ///< from A to B; within A to feature 2
};

/// @brief A pair of features of the scene that may touch.
struct SceneCandidate {
  fcl::ContinuousContactKind kind{fcl::ContinuousContactKind::kVertexFace};
  std::array<SceneVertex, 4> vertices;
  int num_vertices{4};
  /// As those of a SceneContact.
  std::array<std::intptr_t, 2> triangles{{-1, -1}};
  std::array<fcl::PrimitiveKind, 2> triangle_kinds{};
  double window_lo{0};  ///< they do not touch before, or after window_hi
  double window_hi{1};
};

/// @brief Seconds of each part of a step.
struct StepTimes {
  double build{0};
  double update{0};
  double traverse{0};
  double test{0};
  double total() const { return update + traverse + test; }
};

struct StepResult {
  /// The crossings at t = 0, then the contacts, earliest first.
  std::vector<SceneContact> contacts;
  bool at_distance{false};  ///< whether features that come near are contacts
  /// Whether the query was for any contact: then there is at most one.
  bool is_any{false};
  /// Whether all meshes were tested. Not if the query for any contact ended before.
  bool is_decided{true};
  fcl::StageCounts counts;
  StepTimes times;  ///< `build` is 0

  /// @brief The earliest contact or crossing that was found, or null.
  const SceneContact* earliest() const {
    return contacts.empty() ? nullptr : &contacts.front();
  }

  /// @brief Whether an edge passes through a triangle at t = 0; nothing if this is not
  /// decided.
  std::optional<bool> initiallyCrossing() const;

  /// @brief Whether nothing can come before earliest().
  bool isFirstDecided() const;
};

/// @brief The triangles of mesh A, and of B if there is one, and what is free in them;
/// null if nothing is.
struct SceneTriangles {
  const Triangles* a{nullptr};
  const Triangles* b{nullptr};
  const FreeElements* free_a{nullptr};
  const FreeElements* free_b{nullptr};
};

/// @brief The vertex positions of one frame: mesh A, and B if there is one.
struct SceneFrame {
  const Vertices* a{nullptr};
  const Vertices* b{nullptr};
};

/// @brief One or two meshes that deform from frame to frame.
class Scene {
 public:
  /// @brief Builds the models, settings.repeat times.
  /// @throws std::runtime_error with the name of the mesh ("A", "B") that the library
  /// refuses.
  Scene(const SceneTriangles& triangles, const SceneFrame& frame,
        const StepSettings& settings);

  /// @brief The shortest time of building the models, in seconds.
  double buildTime() const { return build_time_; }

  /// @brief Moves the models from one frame to the next and runs the queries,
  /// settings.repeat times. The times are those of the run with the smallest total. A
  /// mesh whose two frames are the same object stands still.
  StepResult step(const SceneFrame& from, const SceneFrame& to);

  /// @brief Moves the models from one frame to the next and finds the pairs that a query
  /// would test. They are sorted by kind and vertices, those of A first.
  std::vector<SceneCandidate> candidates(const SceneFrame& from, const SceneFrame& to);

  /// @brief The same step once more, with all crossings, positions and normals.
  StepResult stepInDetail(const SceneFrame& from, const SceneFrame& to);

 private:
  using Model = MeshModel::Model;
  using Body = MeshModel;

  Body build(const Triangles& triangles, const FreeElements* free,
             const Vertices& vertices, const char* name, double& seconds) const;
  StepResult runOnce(const SceneFrame& from, const SceneFrame& to);
  void build(const SceneTriangles& triangles, const SceneFrame& frame);
  void move(const SceneFrame& from, const SceneFrame& to);
  void query(const Body& o1, const Body& o2, StepResult& step) const;
  void addCandidates(const Body& o1, const Body& o2,
                     std::vector<SceneCandidate>& candidates) const;

  StepSettings settings_;
  double build_time_{0};
  Body a_;
  Body b_;  ///< without a model if there is no B
};

}  // namespace fcl_ccd

#endif
