// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BVH_DEFORMABLE_BVH_MODEL_H
#define FCL_BVH_DEFORMABLE_BVH_MODEL_H

#if __cplusplus < 201703L
#error "DeformableBVHModel needs C++17: compile with -std=c++17 or later"
#endif

#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fcl/ccd_version.h"
#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"

#if defined(__GXX_RTTI) || defined(__cpp_rtti)
#define FCL_CCD_FINAL_WITHOUT_RTTI
#else
#define FCL_CCD_FINAL_WITHOUT_RTTI final
#endif

namespace fcl {

/// @brief Two vertices that an edge without a triangle joins: a piece of a cable or rod.
using FreeEdge = std::array<std::size_t, 2>;

/// @brief What a contact's b1 or b2 stands for; see DeformableBVHModel::primitive().
enum class PrimitiveKind { kTriangle, kFreeEdge, kFreePoint };

/// @brief A triangle, a free edge or a free point, by its number among its kind.
struct Primitive {
  PrimitiveKind kind;
  std::size_t index;
};

namespace detail {

namespace deformable {
class MovingKdopTree;
class VertexFrames;
}  // namespace deformable

/// @brief The arrays and the state of a BVHModel at one time, to compare with a later
/// time.
struct ModelArrays {
  const void* vertices{nullptr};
  const void* prev_vertices{nullptr};
  const void* tri_indices{nullptr};
  int num_vertices{0};
  int num_tris{0};
  BVHBuildState build_state{BVH_BUILD_STATE_EMPTY};

  bool operator==(const ModelArrays& other) const;
};

/// @brief The state of a DeformableBVHModel: its phase, the state of FCL's tree, and the
/// begin...Model() that is open. A change of the base through a reference to its class
/// calls nothing here. Therefore the functions take the base's arrays as they are `now`.
///
/// Invariants, which seal() asserts: a model in step has both frames, and its build_state
/// is BVH_BUILD_STATE_BEGUN if FCL's tree is missing, else BVH_BUILD_STATE_PROCESSED.
class ModelState {
 public:
  enum class Phase {
    kUnbuilt,            ///< open, or without beginModel()
    kGrown,              ///< open again after endModel()
    kInStep,             ///< built; the moving tree belongs to the base's arrays
    kHalfUpdated,        ///< an exception ended an update
    kChangedThroughBase  ///< built; only the base knows the frames
  };
  /// FCL's own tree of a model in step.
  enum class FclTreeIs { kMissing, kBehind, kUpToDate };
  enum class OpenUpdate { kNone, kUpdate, kReplace };

  Phase phase(const ModelArrays& now) const;
  FclTreeIs fclTree() const { return fcl_tree_; }
  OpenUpdate openUpdate() const { return open_; }

  /// @brief Whether vertices were added through the base class to a model that ended
  /// without FCL's tree. The array of its previous frame has no room for them.
  bool isPreviousShort(const ModelArrays& now) const;

  /// @brief The state of a copy. The base of the copy has the arrays `copied`.
  ModelState ofCopy(const ModelArrays& now, const ModelArrays& copied) const;

  void beginUpdate(OpenUpdate what, const ModelArrays& now);
  /// @return whether the arrays are the same as at beginUpdate()
  bool endUpdate(const ModelArrays& now);

  /// @brief From here to seal() a failure leaves an open model.
  void beginBuild();
  /// @brief From here to seal() a failure leaves a model that is half updated.
  void beginChange();
  /// @brief The base has a new array for the previous frame of all vertices.
  void setPrevious(const ModelArrays& now);
  /// @brief FCL has moved the array of the current frame of a model in step.
  void setCurrent(const ModelArrays& now);
  void setFclTree(FclTreeIs is) { fcl_tree_ = is; }
  /// @brief The build_state of the base while the model is in step.
  BVHBuildState builtState() const;
  /// @brief From now on the model is in step with these arrays.
  void seal(const ModelArrays& now);

 private:
  enum class Made { kNothing, kTree, kHalfATree };

  Made made_{Made::kNothing};
  /// The arrays for which the moving tree was made. Without a tree: the last array that
  /// was made for the previous frame, and its number of vertices.
  ModelArrays made_for_;
  FclTreeIs fcl_tree_{FclTreeIs::kMissing};
  OpenUpdate open_{OpenUpdate::kNone};
  ModelArrays opened_on_;
};

/// @brief The part of a DeformableBVHModel that does not depend on its BV: feature
/// owners, moving tree, state, and the checks of its input.
class DeformableMesh {
 public:
  virtual ~DeformableMesh();

  const deformable::MovingKdopTree& movingTree() const { return *tree_; }

  /// @brief Whether a vertex differs between the two frames.
  bool isDeforming() const { return is_deforming_; }

  /// @brief The number of free edges and points; see DeformableBVHModel::addEdge().
  std::size_t numFreeEdges() const { return free_edges_.size(); }
  std::size_t numFreePoints() const { return free_points_.size(); }

  /// @brief The vertices of a free edge, and the vertex of a free point, in the order in
  /// which they were added.
  const FreeEdge& freeEdge(std::size_t i) const {
    assert(i < free_edges_.size());
    return free_edges_[i];
  }
  std::size_t freePoint(std::size_t i) const {
    assert(i < free_points_.size());
    return free_points_[i];
  }

  /// @brief The number given to setNumThreads(); 1 by default.
  int numThreads() const { return num_threads_; }

  /// @brief How many updates since the build have restructured parts of the moving tree.
  std::size_t numRestructurings() const { return num_restructurings_; }

  /// @brief A number that is another one after each change of the frames or triangles.
  using Revision = std::shared_ptr<std::atomic<std::uint64_t>>;

  /// @brief That of the model. Who keeps a copy of the pointer may outlive the model.
  const Revision& revision() const { return revision_; }
  /// @brief The number of the last change of any model. While it stays, no model has
  /// changed.
  static std::uint64_t lastRevision();

  /// @brief Whether an update or replacement has begun and not ended.
  bool isUpdateOpen() const { return state_.openUpdate() != OpenUpdate::kNone; }

  /// @brief Whether the moving tree belongs to the arrays that the base model has now.
  /// False after a change through a reference to the base class.
  virtual bool isInStep() const = 0;

  /// @brief The two frames in model coordinates. Call it only while isInStep().
  virtual deformable::VertexFrames frames() const = 0;

 protected:
  using Phase = ModelState::Phase;
  using FclTreeIs = ModelState::FclTreeIs;
  using OpenUpdate = ModelState::OpenUpdate;

  DeformableMesh();
  DeformableMesh(const DeformableMesh& other);
  /// @brief Moves. After it `other` can only be destroyed.
  DeformableMesh& operator=(DeformableMesh&& other) noexcept;

  /// @brief The base model's arrays as they are now.
  virtual ModelArrays arrays() const = 0;
  Phase phase() const { return state_.phase(arrays()); }
  bool isBuilt() const;
  /// @brief Whether FCL's tree is missing, or belongs to other frames or triangles.
  bool isFclTreeBehind() const;

  /// @brief Whether the model has free edges or points, which FCL's tree cannot hold.
  bool hasFree() const { return !free_edges_.empty() || !free_points_.empty(); }
  /// @brief Room for more of them, so that addFree() allocates nothing.
  void reserveFree(std::size_t num_edges, std::size_t num_points);
  /// @param first  the id of vertex 0 of their submodel
  void addFree(const std::vector<FreeEdge>& edges, const std::vector<std::size_t>& points,
               std::size_t first);
  void dropFree();

  /// @name Checks that return FCL's code and say for lastError() what is wrong
  /// @{
  int refuse(int code, std::string why);
  int accept();
  int allowThreads(int num_threads);
  int checkCount(std::size_t num_vertices);
  int checkFinite(const float* coordinates, std::size_t count, const char* frame);
  int checkFinite(const double* coordinates, std::size_t count, const char* frame);
  int checkTriangles(const Triangle* triangles, std::size_t num_triangles,
                     std::size_t num_vertices);
  int checkOrigins(const std::vector<int>& origins, std::size_t num_triangles);
  int checkFree(const std::vector<FreeEdge>& edges,
                const std::vector<std::size_t>& points, std::size_t num_vertices);
  /// endModel() checks again: the base class may have begun another model.
  int checkFree(std::size_t num_vertices) {
    return checkFree(free_edges_, free_points_, num_vertices);
  }
  /// endModel() needs an open model.
  int checkInConstruction();
  /// Whoever gives both frames needs a model that is built, with no update open.
  int checkSteppable(const char* caller);
  int checkFclTreeUpdate();
  int openUpdate(OpenUpdate what, const char* caller);
  int checkOpen(OpenUpdate expected);
  int closeUpdate(OpenUpdate expected, const char* caller);
  /// @}

  /// @brief Throws fcl::Exception if FCL's tree cannot answer.
  void checkDiscreteQuery(int num_bvs) const;
  /// @brief Throws fcl::Exception if FCL's copy constructor would read beyond an array.
  void checkCopy() const;

  /// @brief Computes owners and tree structure for triangles that have been checked.
  void buildTree(const Triangle* triangles, std::size_t num_triangles,
                 const deformable::VertexFrames& frames);

  /// @brief Restructures the aged parts of the tree, then computes boxes for a pair of
  /// frames.
  void refitTree(const deformable::VertexFrames& frames);

  /// @brief Changes tree and owners to triangles that have been checked, as
  /// MovingKdopTree::changeTopology(). Computes no boxes.
  void changeTopology(const Triangle* triangles, std::size_t num_triangles,
                      const std::vector<int>& origins,
                      const deformable::VertexFrames& frames);

  /// @brief Computes boxes for a pair of frames after a change of topology.
  void refitChangedTree(const deformable::VertexFrames& frames);

  std::size_t treeMemUsage() const;

  ModelState state_;
  std::string last_error_;

 private:
  void takeRevision();

  std::unique_ptr<deformable::MovingKdopTree> tree_;
  int num_threads_{1};
  std::vector<Triangle> leavesOf(const Triangle* triangles,
                                 std::size_t num_triangles) const;

  std::size_t num_restructurings_{0};
  Revision revision_{std::make_shared<std::atomic<std::uint64_t>>(0)};
  bool is_deforming_{false};
  std::vector<FreeEdge> free_edges_;
  std::vector<std::size_t> free_points_;
};

}  // namespace detail

/// @brief Whether a build or an update brings FCL's own tree up to date.
///
/// FCL's discrete queries (collide, distance) need this tree. So do continuous queries
/// that FCL answers (point clouds, and motion classes that are no BoundedMotion).
/// Continuous queries that this library answers do not need it. Broadphase managers do
/// not need it, with one exception: collide(&object, ...) and distance(&object, ...) of
/// the DynamicAABBTree managers read the node type of `object`, and throw as discrete
/// queries do.
enum class FclTree {
  kUpdate,  ///< bring the tree up to date
  kSkip     ///< leave the tree; queries that need it throw until updateFclTree()
};

/// @brief A triangle mesh that deforms between two frames. It is a BVHModel<BV> with a
/// moving 16-DOP tree beside FCL's tree, and can be used wherever FCL takes a
/// BVHModel<BV>.
///
/// Use: beginModel / addVertex / addTriangle / addSubModel / endModel build the model
/// once. Both frames are equal then. Each step gives the next frame in one of these ways:
/// - beginUpdateModel / updateVertex / updateSubModel / endUpdateModel: the current frame
///   becomes the previous one;
/// - updateFrames: both frames at once;
/// - updateTopology: a step in which the mesh tears, breaks, grows or loses parts. The
///   tree changes where the mesh changes.
///
/// A step refits the boxes of the tree. When motion has made the boxes of a part poor,
/// the next step restructures this part. That changes the time of queries and nothing
/// else. numRestructurings() counts these steps.
///
/// Cables, rods and points: a model may hold free edges and free points beside triangles
/// or without them (addEdge(), addPoint(), addSubModel()). They are features as those of
/// triangles: an edge with its ends, a point as a vertex. Where a triangle has the same
/// edge or vertex, or another one was added before, it is one feature. Updates give their
/// vertices with all others. In contacts b1 and b2 number the triangles first, then the
/// free edges, then the free points; primitive() tells which it is. Continuous queries
/// know them: pairs under every motion, with meshes, shapes and octrees; self-collision;
/// candidates; safe displacements. With min_distance = 0 a point meets faces and edges
/// meet edges; that a point meets an edge or a point exactly is not looked for. FCL's own
/// tree does not hold them: it is never built (FclTree::kUpdate acts as kSkip), and
/// queries that need it throw.
///
/// Errors: functions return FCL's BVHReturnCode and print nothing; lastError() has the
/// text. After an error the model is what it was before the call (before the begin...
/// call, for a begin/end sequence). An exception (std::bad_alloc) in endModel() leaves
/// the model open, as an error does. An exception in an update may leave the model half
/// updated: every query and copy of it then throws fcl::Exception, and beginUpdateModel()
/// is refused, until updateFrames(), updateTopology() or a replacement gives both frames.
/// A begin... call while an update is open drops the vertices given so far. beginModel()
/// is that of FCL: for a model that is built it prints, clears the model and returns an
/// error. A second call of it then begins the new model.
///
/// Differences from BVHModel:
/// - build_state is BVH_BUILD_STATE_PROCESSED after an update, so that FCL's discrete
///   queries use the model's transform (in the UPDATED state they ignore it). After
///   endModel(FclTree::kSkip) it is BVH_BUILD_STATE_BEGUN, since FCL's tree is not built;
/// - prev_vertices is never null in a built model;
/// - getNodeType() throws fcl::Exception while FCL's tree is missing or out of date:
///   after FclTree::kSkip, after an update that failed, and before the model is built.
///   Every query of FCL calls it first;
/// - the local AABB contains both frames and is up to date after every build and update.
///
/// No update function of BVHModel is virtual. The model notices an update through a
/// pointer or reference to BVHModel<BV>. Continuous queries then read the frames of the
/// base class and build a tree in each call, as for a plain BVHModel, until the next
/// update through this class. Do not add vertices through the base class to a model that
/// ended with FclTree::kSkip: FCL would write its next update beyond the end of the
/// previous frame.
///
/// Thread-safety: concurrent const access is safe. FCL's discrete queries of one model
/// may run in several threads, since bv_splitter and bv_fitter keep their state for each
/// thread. (This does not hold for a plain BVHModel of AABBs, KDOPs or RSSs: concurrent
/// discrete queries of one such model crash, as in stock FCL. Give each thread a copy of
/// the model with its own bv_splitter and bv_fitter.) Copies are deep and independent. A
/// build or an update runs in the caller's thread unless setNumThreads() allows more.
///
/// A class of the program that derives from this one needs RTTI: queries know the model
/// by it. In a program that is compiled with -fno-rtti this class is final.
///
/// @tparam BV  a bounding volume of FCL: AABB, OBB, RSS, kIOS, OBBRSS or KDOP of 16, 18
/// or 24, in double or float. It is used by FCL's own tree only.
template <typename BV = KDOP<double, 16>>
class FCL_EXPORT DeformableBVHModel FCL_CCD_FINAL_WITHOUT_RTTI
    : public BVHModel<BV>,
      public detail::DeformableMesh {
 public:
  using S = typename BV::S;
  using Base = BVHModel<BV>;

  DeformableBVHModel();
  DeformableBVHModel(const DeformableBVHModel& other);
  DeformableBVHModel& operator=(const DeformableBVHModel& other);
  ~DeformableBVHModel();

  /// @brief Sets the number of threads of builds and updates, from the next one on. 1
  /// (the default): the caller's thread, without tasks. n: at most n threads. 0: as many
  /// as the oneTBB task arena around the call has. The model does not depend on this
  /// number. FCL's own tree is always built in one thread. Queries have their own number,
  /// ContinuousContactRequest::num_threads.
  ///
  /// Errors: a negative number (BVH_ERR_INCORRECT_DATA).
  int setNumThreads(int num_threads);

  /// @brief As BVHModel::beginModel(). The model forgets its free edges and points.
  int beginModel(int num_tris = 0, int num_vertices = 0);

  /// @name Add to a model that is open. A model that ended with FclTree::kSkip is opened
  /// again. Refused for any other model (BVH_ERR_BUILD_OUT_OF_SEQUENCE).
  /// @{
  int addVertex(const Vector3<S>& p);
  int addTriangle(const Vector3<S>& p1, const Vector3<S>& p2, const Vector3<S>& p3);
  int addSubModel(const std::vector<Vector3<S>>& ps);
  int addSubModel(const std::vector<Vector3<S>>& ps, const std::vector<Triangle>& ts);
  /// @brief Adds a free edge between two new vertices.
  int addEdge(const Vector3<S>& p1, const Vector3<S>& p2);
  /// @brief Adds a free point at a new vertex.
  int addPoint(const Vector3<S>& p);
  /// @brief Adds triangles, free edges and free points, by numbers of the vertices `ps`.
  ///
  /// Errors: a number that is not below ps.size(), an edge of a vertex with itself
  /// (BVH_ERR_INCORRECT_DATA). Nothing is added then.
  int addSubModel(const std::vector<Vector3<S>>& ps, const std::vector<Triangle>& ts,
                  const std::vector<FreeEdge>& edges,
                  const std::vector<std::size_t>& points = {});
  /// @}

  /// @brief What number b of a contact stands for (ContinuousContact::b1, b2).
  /// @pre 0 <= b < num_tris + numFreeEdges() + numFreePoints()
  Primitive primitive(std::intptr_t b) const;

  /// @brief Ends the construction and builds the moving tree. FclTree says whether FCL's
  /// tree is built too.
  ///
  /// Errors: no triangles, free edges or free points (BVH_ERR_BUILD_EMPTY_MODEL); more
  /// than 2^29 of them or of vertices, a coordinate that is not finite, a vertex index
  /// out of range (BVH_ERR_INCORRECT_DATA); a model that has ended and not grown since
  /// (BVH_ERR_BUILD_OUT_OF_SEQUENCE). After the first two the model stays open: you may
  /// correct `vertices` and `tri_indices` in place, add more, and call endModel() again.
  int endModel(FclTree fcl_tree = FclTree::kUpdate);

  /// @name Replace the current frame. Both frames become equal (no motion).
  /// @{
  int beginReplaceModel();
  int replaceVertex(const Vector3<S>& p);
  int replaceTriangle(const Vector3<S>& p1, const Vector3<S>& p2, const Vector3<S>& p3);
  int replaceSubModel(const std::vector<Vector3<S>>& ps);
  int endReplaceModel(bool refit = true, bool bottomup = true);
  /// @}

  /// @name Give the next frame, vertex by vertex or in parts. The current frame becomes
  /// the previous one. FCL's tree is brought up to date if it was built. `refit` and
  /// `bottomup` concern FCL's tree only. Trees of OBB, RSS, OBBRSS and kIOS are always
  /// refit from the top down, since FCL's bottom-up refit can leave points out.
  /// @{
  int beginUpdateModel();
  int updateVertex(const Vector3<S>& p);
  int updateTriangle(const Vector3<S>& p1, const Vector3<S>& p2, const Vector3<S>& p3);
  int updateSubModel(const std::vector<Vector3<S>>& ps);
  int endUpdateModel(bool refit = true, bool bottomup = true);
  /// @}

  /// @brief Gives both frames at once.
  /// @param previous, current  num_vertices x 3 coordinates each (x y z x y z ...), in
  /// model coordinates. They are copied, and may be the model's own arrays.
  /// @param num_vertices  the number of vertices of the model
  /// @param fcl_tree  whether FCL's own tree is brought up to date; see FclTree
  ///
  /// Errors: a model that is not built (BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME); an update is
  /// open (BVH_ERR_BUILD_OUT_OF_SEQUENCE); a null frame, another number of vertices, a
  /// coordinate that is not finite (BVH_ERR_INCORRECT_DATA).
  int updateFrames(const S* previous, const S* current, std::size_t num_vertices,
                   FclTree fcl_tree = FclTree::kSkip);

  /// @brief Gives the next step of a mesh that has torn, broken, grown or lost parts: its
  /// triangles and both frames. The moving tree changes where the mesh changes. All
  /// answers are those of a model that is built anew. numRestructurings() does not count
  /// these calls.
  /// @param triangles  all triangles of the new mesh, with vertex ids of the new frames;
  /// copied
  /// @param origins  a hint that saves time and never changes an answer. For each
  /// triangle it has the number of the triangle of the old mesh that it was, or was cut
  /// from; -1 for a new triangle. Empty: triangle i was triangle i, and triangles beyond
  /// the old number are new. Vertex ids may change freely.
  /// @param previous, current  num_vertices x 3 coordinates each, as in updateFrames()
  /// @param fcl_tree  whether FCL's own tree is built, which takes longer than the rest
  /// of the call. Without it discrete queries throw until updateFclTree().
  ///
  /// Errors: those of endModel() and updateFrames(); also a wrong number of origins, or
  /// one out of range (BVH_ERR_INCORRECT_DATA); a model with free edges or points, which
  /// needs the other overload (BVH_ERR_UNSUPPORTED_FUNCTION).
  int updateTopology(const std::vector<Triangle>& triangles,
                     const std::vector<int>& origins, const S* previous, const S* current,
                     std::size_t num_vertices, FclTree fcl_tree = FclTree::kSkip);

  /// @brief The same for a mesh that has free edges or points, before or after the step:
  /// gives all of them too, with vertex ids of the new frames. The moving tree is built
  /// anew.
  ///
  /// Errors: those of addSubModel(), endModel() and updateFrames().
  int updateTopology(const std::vector<Triangle>& triangles,
                     const std::vector<FreeEdge>& edges,
                     const std::vector<std::size_t>& points, const S* previous,
                     const S* current, std::size_t num_vertices);

  /// @brief Brings FCL's own tree up to date. Builds it if there is none.
  ///
  /// Errors: the model is not built (BVH_ERR_BUILD_EMPTY_MODEL); an update is open
  /// (BVH_ERR_BUILD_OUT_OF_SEQUENCE) or has failed (BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME);
  /// free edges or points (BVH_ERR_UNSUPPORTED_FUNCTION); FCL's own codes.
  int updateFclTree();

  /// @brief Whether FCL's own tree is built and up to date. Discrete queries need that.
  bool isFclTreeUpToDate() const;

  /// @brief The text of the last call's error, for example "vertex 17 of the current
  /// frame is not finite". Empty if the last call succeeded.
  const std::string& lastError() const;

  /// @brief Bytes that this class needs beside those of a BVHModel<BV> with two frames.
  std::size_t deformableMemUsage() const;

  bool isInStep() const override;
  detail::deformable::VertexFrames frames() const override;
  NODE_TYPE getNodeType() const override;
  void computeLocalAABB() override;

  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

 private:
  detail::ModelArrays arrays() const override;
  static const Base& copyable(const DeformableBVHModel& model);
  int checkFrames(const S* previous, const S* current, std::size_t num_vertices);
  int open(OpenUpdate what, const char* caller);
  int stage(const Vector3<S>* points, std::size_t count, OpenUpdate expected);
  int close(OpenUpdate expected, const char* caller);
  template <typename Add>
  int grow(Add&& add);
  void shiftFrames(const S* previous, FclTree fcl_tree, bool refit, bool bottomup);
  void finish();
  void seal();
  void fitPerThread();
  void makeRoom();
  void swapBase(Base& other);

  /// Coordinates given since begin.... A refused frame changes nothing.
  std::vector<Vector3<S>> staged_;
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
#undef FCL_CCD_FINAL_WITHOUT_RTTI

}  // namespace fcl

#endif
