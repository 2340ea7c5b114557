// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BVH_DEFORMABLE_BVH_MODEL_H
#define FCL_BVH_DEFORMABLE_BVH_MODEL_H

#if __cplusplus < 201703L
#error "DeformableBVHModel needs C++17: compile with -std=c++17 or later"
#endif

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "fcl/ccd_version.h"
#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"

namespace fcl {

namespace detail {

namespace deformable {
class MovingKdopTree;
class VertexFrames;
}  // namespace deformable

/// @brief The part of a DeformableBVHModel that does not depend on its BV: feature
/// owners, moving tree, and what a query must know of the model's state.
class DeformableMesh {
 public:
  virtual ~DeformableMesh();

  const deformable::MovingKdopTree& movingTree() const { return *tree_; }

  /// @brief Whether a vertex differs between the two frames.
  bool isDeforming() const { return is_deforming_; }

  /// @brief As given to setNumThreads().
  int numThreads() const { return num_threads_; }

  /// @brief How many updates since the build have made parts of the tree anew.
  std::size_t numRestructurings() const { return num_restructurings_; }

  /// @brief Whether an update or replacement has begun and not ended.
  bool isUpdateOpen() const { return open_ != Open::kNone; }

  /// @brief Whether the moving tree describes the base model's arrays as they are now;
  /// false when they were changed through a reference to the base class.
  virtual bool isInStep() const = 0;

  /// @brief The two frames, model coordinates; only while in step.
  virtual deformable::VertexFrames frames() const = 0;

 protected:
  enum class Open { kNone, kUpdate, kReplace };

  DeformableMesh();
  DeformableMesh(const DeformableMesh& other);
  /// @brief Leaves a mesh behind that can only be destroyed.
  DeformableMesh& operator=(DeformableMesh&& other) noexcept;

  /// @brief Owners and tree structure anew, for triangles that have been checked.
  void buildTree(const Triangle* triangles, std::size_t num_triangles,
                 const deformable::VertexFrames& frames);

  /// @brief Boxes for a pair of frames, in a tree whose aged parts are made anew.
  void refitTree(const deformable::VertexFrames& frames);

  /// @brief Tree and owners for triangles that have been checked, as
  /// MovingKdopTree::changeTopology(); without boxes.
  void changeTopology(const Triangle* triangles, std::size_t num_triangles,
                      const std::vector<int>& origins,
                      const deformable::VertexFrames& frames);

  /// @brief Boxes for a pair of frames after a change of topology.
  void refitChangedTree(const deformable::VertexFrames& frames);

  std::size_t treeMemUsage() const;

  Open open_{Open::kNone};
  int num_threads_{1};

 private:
  std::unique_ptr<deformable::MovingKdopTree> tree_;
  std::size_t num_restructurings_{0};
  bool is_deforming_{false};
};

}  // namespace detail

/// @brief What a build or an update does with FCL's own tree, which discrete queries
/// (collide, distance) need, and continuous ones that FCL answers (shapes, motion classes
/// of the program's own), but none that is answered here. Of the broadphase managers the
/// DynamicAABBTree ones ask the object that they are queried with, collide(&object, ...)
/// or distance(&object, ...), for its node type: they throw as discrete queries do,
/// whatever the callback does. Other queries of theirs, and other managers, do not.
enum class FclTree {
  kUpdate,  ///< bring it up to date
  kSkip     ///< leave it; queries that need it throw until updateFclTree()
};

/// @brief A triangle mesh that deforms between two frames: BVHModel<BV> with a moving
/// 16-DOP tree of its own beside FCL's. Usable wherever FCL takes a BVHModel<BV>.
///
/// Life: beginModel / addVertex / addTriangle / addSubModel / endModel build it once,
/// both frames equal. Each step then gives the next frame, through beginUpdateModel /
/// updateVertex / updateSubModel / endUpdateModel (the current frame becomes the previous
/// one), or both frames at once through updateFrames. A step refits the boxes; the tree
/// stays until motion has made its boxes poor: then a step makes the aged parts anew
/// (numRestructurings() counts these steps), which changes the time of queries and
/// nothing else. What decides is the boxes of the step before. A step in which the mesh
/// tears, breaks, grows or loses parts goes through updateTopology, which changes the
/// tree where the mesh has changed.
///
/// Errors: functions return FCL's BVHReturnCode; on any error the model is what it was
/// before the call (before the begin... call, for a begin/end sequence), nothing is
/// printed, and lastError() says what is wrong. An exception (std::bad_alloc) in
/// endModel() leaves the model open, as an error does. An update that an exception ends
/// may be half done: until updateFrames(), updateTopology() or a replacement has given
/// both frames, every query and copy of the model throws fcl::Exception and
/// beginUpdateModel() is refused. A begin... while an update is open drops what was given
/// since the one before. beginModel() is FCL's own: called for a model that is built it
/// prints, clears it and returns an error; a second one begins.
///
/// Inherited behaviour that differs from BVHModel:
/// - build_state is BVH_BUILD_STATE_PROCESSED after an update too, so that FCL's discrete
///   queries keep a model's transform (in the UPDATED state they drop it); after
///   endModel(FclTree::kSkip) it is BVH_BUILD_STATE_BEGUN: FCL's tree is still to be
///   built;
/// - prev_vertices is never null in a built model;
/// - getNodeType() throws fcl::Exception while FCL's tree is out of date, which it is
///   after FclTree::kSkip, or an update has failed, or there is none, since the model is
///   not built: every query of FCL's starts with it;
/// - the local AABB contains both frames and is up to date after every build and update.
///
/// No update function of BVHModel is virtual. One called through a pointer or reference
/// to BVHModel<BV> is noticed: continuous queries then read the base's frames and build
/// a tree per call, as for a plain BVHModel, until the next update through this class.
/// Nothing may be added through the base to a model that ended with FclTree::kSkip: FCL
/// would write its next update beyond the end of the previous frame.
///
/// Thread-safety: concurrent const access is safe, and so are FCL's discrete queries of
/// one model in several threads: its bv_splitter and bv_fitter, which FCL's queries use
/// and copies share, are FCL's for each thread. (FCL's own keep a state: concurrent
/// discrete queries of one AABB, KDOP or RSS model that is no DeformableBVHModel crash,
/// as in stock FCL. Give each thread its own copy of the model, with its own bv_splitter
/// and bv_fitter.) Copies are deep and independent, with these too, whatever the original
/// has. A build or an update runs on the caller's thread alone unless setNumThreads()
/// allows more.
template <typename BV = KDOP<double, 16>>
class FCL_EXPORT DeformableBVHModel : public BVHModel<BV>, public detail::DeformableMesh {
 public:
  using S = typename BV::S;
  using Base = BVHModel<BV>;

  DeformableBVHModel();
  DeformableBVHModel(const DeformableBVHModel& other);
  DeformableBVHModel& operator=(const DeformableBVHModel& other);
  ~DeformableBVHModel();

  /// @brief Allows builds and updates, from the next one on, so many threads: 1, the
  /// caller's own and no task (the default); n, at most n; 0, as many as the oneTBB task
  /// arena around has. The model that results does not depend on it. FCL's own tree is
  /// always made on one thread. Queries have a number of their own,
  /// ContinuousContactRequest::num_threads. Refuses a negative number
  /// (BVH_ERR_INCORRECT_DATA).
  int setNumThreads(int num_threads);

  /// @name Add to a model that is open, or that ended with FclTree::kSkip, which opens it
  /// again; refused for any other (BVH_ERR_BUILD_OUT_OF_SEQUENCE).
  /// @{
  int addVertex(const Vector3<S>& p);
  int addTriangle(const Vector3<S>& p1, const Vector3<S>& p2, const Vector3<S>& p3);
  int addSubModel(const std::vector<Vector3<S>>& ps);
  int addSubModel(const std::vector<Vector3<S>>& ps, const std::vector<Triangle>& ts);
  /// @}

  /// @brief Ends the construction; see FclTree for the choice. Refuses a model without
  /// triangles (BVH_ERR_BUILD_EMPTY_MODEL), more than 2^29 triangles or vertices,
  /// coordinates that are not finite and vertex indices out of range
  /// (BVH_ERR_INCORRECT_DATA); the model stays open: `vertices` and `tri_indices` may be
  /// corrected in their places, more be added, and endModel() called again. Refuses a
  /// model that has ended and not grown since (BVH_ERR_BUILD_OUT_OF_SEQUENCE).
  int endModel(FclTree fcl_tree = FclTree::kUpdate);

  /// @name Replace the current frame; both frames become equal (no motion).
  /// @{
  int beginReplaceModel();
  int replaceVertex(const Vector3<S>& p);
  int replaceTriangle(const Vector3<S>& p1, const Vector3<S>& p2, const Vector3<S>& p3);
  int replaceSubModel(const std::vector<Vector3<S>>& ps);
  int endReplaceModel(bool refit = true, bool bottomup = true);
  /// @}

  /// @name Give the next frame, vertex by vertex or in parts; the current frame becomes
  /// the previous one. FCL's tree is brought up to date unless it was never built.
  /// `refit` and `bottomup` concern FCL's tree only; trees of RSS, OBBRSS and kIOS are
  /// always refit from the top down, since FCL's merge of two RSSs can leave points out.
  /// @{
  int beginUpdateModel();
  int updateVertex(const Vector3<S>& p);
  int updateTriangle(const Vector3<S>& p1, const Vector3<S>& p2, const Vector3<S>& p3);
  int updateSubModel(const std::vector<Vector3<S>>& ps);
  int endUpdateModel(bool refit = true, bool bottomup = true);
  /// @}

  /// @brief Gives both frames at once.
  /// @param previous, current  num_vertices x 3 coordinates each (x y z x y z ...), model
  /// frame, copied; may be the model's own arrays.
  /// @param num_vertices  must equal the model's.
  /// @param fcl_tree  whether FCL's own tree follows; see there what throws if not.
  int updateFrames(const S* previous, const S* current, std::size_t num_vertices,
                   FclTree fcl_tree = FclTree::kSkip);

  /// @brief Gives the next step of a mesh that has torn, broken, grown or lost parts: its
  /// triangles and both frames. The moving tree keeps what the mesh keeps, and all
  /// answers are those of a model that is built anew. numRestructurings() does not count
  /// this.
  /// @param triangles  all of them, vertex ids in terms of the new frames; copied
  /// @param origins  for each triangle the number of the one that it was, or was cut
  /// from, before the call, -1 for a new one; empty: triangle i was triangle i, and those
  /// beyond the model's are new. A hint, which saves time. Ids of vertices may change
  /// with no need to say so.
  /// @param previous, current  num_vertices x 3 coordinates each, as in updateFrames()
  /// @param fcl_tree  whether FCL's own tree is built, which takes longer than all else;
  /// else discrete queries throw until updateFclTree().
  ///
  /// Errors: as endModel() and updateFrames(), and origins of another number or out of
  /// range (BVH_ERR_INCORRECT_DATA).
  int updateTopology(const std::vector<Triangle>& triangles,
                     const std::vector<int>& origins, const S* previous, const S* current,
                     std::size_t num_vertices, FclTree fcl_tree = FclTree::kSkip);

  /// @brief Brings FCL's own tree up to date (builds it if it was never built).
  ///
  /// Errors: the model is not built (BVH_ERR_BUILD_EMPTY_MODEL), an update is open
  /// (BVH_ERR_BUILD_OUT_OF_SEQUENCE) or has failed (BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME);
  /// FCL's own.
  int updateFclTree();

  /// @brief Whether FCL's own tree is built and up to date, that is, discrete queries are
  /// allowed.
  bool isFclTreeUpToDate() const;

  /// @brief What the last refused call found, for example "vertex 17 of the current frame
  /// is not finite"; empty if the last call succeeded.
  const std::string& lastError() const;

  /// @brief Bytes that this class holds over BVHModel<BV> with two frames.
  std::size_t deformableMemUsage() const;

  bool isInStep() const override;
  detail::deformable::VertexFrames frames() const override;
  NODE_TYPE getNodeType() const override;
  void computeLocalAABB() override;

  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

 private:
  /// The base's arrays and sizes that the moving tree was made for.
  struct Seal {
    const Vector3<S>* vertices{nullptr};
    const Vector3<S>* prev_vertices{nullptr};
    const Triangle* tri_indices{nullptr};
    int num_vertices{0};
    int num_tris{0};
    BVHBuildState build_state{BVH_BUILD_STATE_EMPTY};

    bool operator==(const Seal& other) const;
  };

  int refuse(int code, std::string why);
  int accept();
  bool isBuilt() const;
  Seal currentSeal() const;
  int checkFinite(const S* coordinates, std::size_t count, const char* frame);
  int checkFrames(const S* previous, const S* current, std::size_t num_vertices);
  int checkSteppable(const char* caller);
  int checkTriangles(const Triangle* triangles, std::size_t num_triangles,
                     std::size_t num_vertices);
  int checkOrigins(const std::vector<int>& origins, std::size_t num_triangles);
  int open(Open what, const char* caller);
  int stage(const Vector3<S>* points, std::size_t count, Open expected);
  int close(Open expected, const char* caller);
  template <typename Add>
  int grow(Add&& add);
  bool isHalfUpdated() const;
  bool isPreviousShort() const;
  static const Base& copyable(const DeformableBVHModel& model);
  bool isFclTreeBehind() const;
  void advance(const S* previous, FclTree fcl_tree, bool refit, bool bottomup);
  void finish();
  void seal();
  void fitPerThread();
  void makeRoom();
  void swapBase(Base& other);

  /// Coordinates given since begin..., so that a refused frame changes nothing.
  std::vector<Vector3<S>> staged_;
  Seal seal_;
  /// When the open update began.
  Seal opened_;
  bool fcl_tree_built_{false};
  bool fcl_tree_up_to_date_{false};
  /// From the first change of an update to the seal.
  bool is_changing_{false};
  std::string last_error_;
};

#define FCL_CCD_EXTERN_MODELS(S)                         \
  extern template class DeformableBVHModel<AABB<S>>;     \
  extern template class DeformableBVHModel<OBB<S>>;      \
  extern template class DeformableBVHModel<RSS<S>>;      \
  extern template class DeformableBVHModel<kIOS<S>>;     \
  extern template class DeformableBVHModel<OBBRSS<S>>;   \
  extern template class DeformableBVHModel<KDOP<S, 16>>; \
  extern template class DeformableBVHModel<KDOP<S, 18>>; \
  extern template class DeformableBVHModel<KDOP<S, 24>>;
FCL_CCD_EXTERN_MODELS(double)
FCL_CCD_EXTERN_MODELS(float)
#undef FCL_CCD_EXTERN_MODELS

}  // namespace fcl

#endif
