// SPDX-License-Identifier: BSD-3-Clause
//
// What --help prints behind the options.
#ifndef FCL_CCD_HELP_TEXT_H
#define FCL_CCD_HELP_TEXT_H

namespace fcl_ccd {

inline constexpr const char* kMainExamples = R"(Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl
  fcl-ccd run scene.json
  fcl-ccd candidates cloth_0.ply cloth_1.ply > candidates.csv
  fcl-ccd queries edge-edge.csv --json errors.json
  fcl-ccd compare cloth-ball/queries

'fcl-ccd COMMAND --help' explains a command. Exit code: 0 when done, with or without
contacts; 2 when the command is refused and no output file is written or changed; 3 and
above when a run stops before its end ('fcl-ccd run --help').)";

inline constexpr const char* kRunDetails = R"(Frames:
  FRAMES is a file, a folder (its meshes; f9 comes before f10), a pattern in quotes
  ('frames/*.ply') or a name with a number (frame_%04d.ply). --start, --end and --stride
  select frames of the last three: numbers for %04d, otherwise files counted from 0.
  All frames of a mesh have the same vertices and faces in the same order.
  Formats: OBJ, PLY (ascii and binary, float and double), OFF (text), STL (ascii and
  binary). Polygons are divided into triangles, in all frames as in the first. A convex
  polygon that turns at every corner becomes the fan of triangles around its first vertex.
  Lines and points of OBJ, and edges of PLY, are cables and points. With --columns
  triangles their numbers begin with e and p.
  All files are checked before the first step. Positions in binary PLY files are checked
  in their step.
  Step i goes from frame i to the next one. Vertices move on straight lines. Frames are
  counted from 0, or have the number in their name (%04d).
  If files at the end are not whole yet, the steps before them are done, and the exit code
  is 6. --follow waits for frames until --end, Ctrl-C, or SECONDS without a new one.

Scenes:
  A name that ends in .json is a scene of many objects, which is tested step by step, each
  object with all others: {"objects": [{"name": "ball", "shape": {"type": "sphere", "radius":
  1}, "poses": [{"translation": [0, 0, 5]}, {"translation": [0, 0, 1]}]}, ...]}. A geometry
  is a mesh (a file), frames (of a mesh that deforms), an octree (.bt or .ot) or a shape:
  sphere, box, capsule, cylinder, cone, ellipsoid, plane, halfspace or convex. Other fields
  of an object: poses, group, thickness, self_collision, min_approach_speed. Fields of the
  file: objects, groups_apart, pair_distances, version. doc/program.md explains them.
  --query, --toc-err, --threads, --contacts, --json, --start and --end act; other options
  are refused. --contacts has the columns step,o1,o2,kind,b1,b2,toc_lo,toc_hi,x,y,z,nx,ny,nz.
  kind is also vs, es, fs (a vertex, edge or face and a shape or cell) or ss (two of these).
  Files are written when all steps are done.

Tests:
  Without --against: A against itself. With --against: A against itself and A against B,
  never B against itself. With --no-self: A against B only. If B has one frame, it does
  not move.
  If no triangle of a mesh shares a vertex, neighbours are reported as contacts. --weld
  joins the vertices that coincide in all frames. Ids are those of the file.

Output:
  A contact is vf (vertex-face) or ee (edge-edge). Each contact is proved. 'crossing' tells
  whether an edge passes through a face at the beginning of the step. 'vertices' and
  'triangles' count those of all meshes.
  With --thickness, features are in contact when their distance reaches D. Then ve (a vertex
  and an edge) and vv (two vertices) are contacts too.
  '--query first' reports the contacts that may be the first. '--query any' reports at most
  one contact. If A touches itself it does not look at B, and says what is not decided.
  --contacts: CSV with the columns step,kind,i0,i1,i2,i3,toc_lo,toc_hi,i4. kind is vf (i0 is
  the vertex, i1 to i3 the face), ee (i0 and i1 are edge a, i2 and i3 edge b) or crossing
  (i0 and i1 are the edge, i2 to i4 the face); ve has no i3, vv no i2 and i3. Ids count from
  0; ids of B begin with b. The first time of contact lies in [toc_lo, toc_hi], in fractions
  of the step. There are also t0,t1 (the triangles of both features; in short: triangles),
  x,y,z (position, the point where they touch) and nx,ny,nz (normal, a unit vector from A to
  B). --columns triangles,position,normal, or some of them, adds these before i4, always in
  this order. Any other list, as in --columns step,i0,toc_lo,normal, has the columns of the
  file in their order.
  --steps: JSON lines: the options, one object for each step, and a summary at the end.
  --json: JSON with all steps and their times in milliseconds. build: making the tree, in
  the first step of each job. total = update + traverse + test.
  --report: a page with table, plots, the first contacts and a 3D view, in one file that
  needs no network. With DIR also contacts.csv, run.json, first_contact.png, first_contact.ply.
  --picture (PNG) and --paint (PLY) show the moment of the first contact, or the end of the
  last step if there is none. --at-step and --at-time choose another moment. A name with a
  number, contact_%04d.png, is a file a step. The contacts up to that moment are in colour.
  In a PLY vertices of vf, ve and vv contacts are red, those of ee contacts orange, those of
  an edge and a face that cross at t = 0 violet. B's vertices come after A's.
  --contacts and --steps grow with each step. Others are written at the end.
  One output may be '-', standard output. Then the table goes to standard error.

Stopping:
  After Ctrl-C, SIGTERM or SIGHUP the steps that have begun are finished. Another signal,
  half a second after the first or later, ends the program at once.
  --resume continues after the last whole step in the files of --contacts and --steps. At
  the end the files are as if the run had never stopped. There may be more frames than
  before, but not with --weld.
  Outputs are locked: a second run that names one of them is refused.
  Exit code: 0 done; 2 refused, no file written or changed; 3 a later frame cannot be read
  or used; 4 an output cannot be written (disk full), or another program took it away; 5 a
  rank of mpirun died; 6 the last frames are not whole yet; 128 + N stopped by signal N.
  After 3 and above the files have all steps that were done, unless they were taken away.

Cores:
  By default the program does as many steps at the same time as there are cores. With
  --repeat or --threads it does one step after the other, so that the times are those of a
  step that has the machine to itself. With --jobs and --threads it does so many steps at
  the same time, with so many threads each. The output is the same.
  'mpirun -n K fcl-ccd run ...' splits the steps over K processes (ranks), also on several
  machines. Rank 0 writes the same files. Each rank does one step at a time, or --jobs.

Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply cloth_2.ply --json times.json --repeat 5
  fcl-ccd run cloth_0.ply cloth_1.ply --query first
  fcl-ccd run cloth_0.ply cloth_1.ply --thickness 0.001 --ignore-initially-closer
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl --resume
  fcl-ccd run frame_%04d.ply --start 100 --end 199 --contacts contacts.csv
  mpirun -n 4 fcl-ccd run frames/ --contacts contacts.csv --steps steps.jsonl
  fcl-ccd run --against ball_0.obj ball_1.obj --no-self -- cloth_0.obj cloth_1.obj
  fcl-ccd run frames/ --report report
  fcl-ccd run frames/ --picture first.png --paint first.ply
  fcl-ccd run scene.json --contacts contacts.csv)";

inline constexpr const char* kCandidatesDetails = R"(Frames:
  Two files, or what names two frames as in 'fcl-ccd run --help'. Vertices move on straight
  lines from the first to the second.

Output:
  A line for each pair of features that a query would test: all pairs that may touch, and
  some that do not. Pairs that share a vertex are not tested. Columns:
  kind,i0,i1,i2,i3,t_lo,t_hi. kind is vf (i0 is the vertex, i1 to i3 the face) or ee (i0 and
  i1 are edge a, i2 and i3 edge b); with --thickness also ve (a free point and a free edge)
  and vv (two free points). Ids count from 0; those of B begin with b. The features do not
  touch before t_lo or after t_hi, in fractions of the step.
  With --thickness D, to touch is to come within D of each other: the list has all pairs that
  may, and t_lo and t_hi are for D.
  The lines are sorted by kind (vf, ee, ve, vv) and ids, so that the output is always the
  same. --columns: these columns, in this order. There are also t0,t1, the triangles of both
  features.
  --output FILE: to a file; then the numbers of candidates are printed.

Examples:
  fcl-ccd candidates cloth_0.ply cloth_1.ply > candidates.csv
  fcl-ccd candidates cloth_0.ply cloth_1.ply --against body.obj --no-self --output c.csv
  fcl-ccd candidates cloth_0.ply cloth_1.ply --columns kind,t0,t1)";

inline constexpr const char* kQueriesDetails = R"(Input:
  Eight rows for each query: four points at t = 0, then the same points at t = 1. The points
  are a vertex and a face (vf), or edge a and edge b (ee). A row is x,y,z as decimal numbers,
  or num,den,num,den,num,den: fractions of integers of any size. Then may come whether the
  features truly touch, 0 or 1, and after it the true first time, or nothing. A first line of
  names is skipped. The value of a decimal is exact: 0.1 is 1/10. Queries with coordinates that
  no double has are decided exactly too, which takes 10 to 100 times as long.
  Without --kind the names tell the kind: they end in vf or vertex-face, ee or edge-edge, or
  are in a folder vertex-face or edge-edge. Of a folder all CSV files below it are taken.

Output:
  Without --print: a table of counts and errors. A wrong time is a true time outside of
  [toc_lo, toc_hi]. The exit code is 0 also if answers or times are wrong.
  --print: index,answer,toc_lo,toc_hi for each query; answer is yes or no. Each answer is
  proved, so that 'uncertain' is 0.
  --columns: these columns and a first line with their names. There are index, answer, toc_lo,
  toc_hi, kind, truth (yes or no), toc (the true time, as the nearest double), not_doubles (how
  many coordinates) and file.
  --json: the counts. Those that need the truth are null without it.

Examples:
  fcl-ccd queries vertex-face.csv
  fcl-ccd queries a/edge-edge.csv b/edge-edge.csv --repeat 10 --json errors.json
  fcl-ccd queries points.csv --kind ee --print --columns index,answer,toc_lo > answers.csv)";

inline constexpr const char* kCompareDetails = R"(Queries:
  CSV files or folders of them, in the form of 'fcl-ccd queries --help'. The truth is in
  their rows, or in a JSON file of true and false for each: for 92vf.csv it is
  92vf_mma_bool.json beside it, or in the folder mma_bool beside its folder. --truth names
  such files, one for each file of queries. One row is printed: queries, those that truly
  touch, contacts that were found, false negatives (FN), false positives (FP), uncertain
  answers, wrong times (outside of [toc_lo, toc_hi]), the largest time error (of toc_lo; both
  '-' if the files have no times), and the mean and the longest time of a query in
  microseconds, each with that of reading the clock.

Frames:
  Two mesh files. The truth is in JSON files of pairs of boxes: of a vertex and a face (name
  in vf.json) or two edges (ee.json). Boxes are numbered: vertices, then edges by their higher
  and their lower vertex, then faces. Whether each pair touches is in 92vf_mma_bool.json, as
  above. Without --truth, the lists for frames/NAME92.ply are boxes/92vf.json and
  boxes/92ee.json. One row is printed: pairs that are listed, those that truly touch,
  candidates of the library, how many listed pairs are candidates (found) and are not
  (missing; they may be apart), contacts of the library, FN and FP of these, and the time of
  the step in milliseconds. A contact that is not listed counts as false positive.

  --kind takes one of the two kinds. --json: the same figures; null if not known. The exit
  code is 0 also if answers are wrong, and 2 if the command is refused or an output cannot be
  written.

Examples:
  fcl-ccd compare Sample-Queries
  fcl-ccd compare vertex-face.csv --repeat 10 --json row.json
  fcl-ccd compare cloth-ball/queries
  fcl-ccd compare cloth-ball/frames/cloth_ball92.ply cloth-ball/frames/cloth_ball93.ply)";

}  // namespace fcl_ccd

#endif
