// A small model made by hand: 2 clusters, 3 keys in 2 clips, 2 textures, colours, 2 kd-trees.
#pragma once

#include "common/motion/model.h"

namespace mdk::test {

/// Two strips of triangles, each in the plane of its cluster: cluster 0 rises along y from key to
/// key, its map moving it back; cluster 1 stands still. Cluster 0's tree has two inner nodes and an
/// empty leaf, cluster 1's is one leaf. No list of the model is empty.
ModelStorage sample_model();

/// The same model, its poses stored as a rig of 3 bones and a morph target that gives the same
/// positions. Only the list of key positions is empty.
ModelStorage sample_rig_model();

/// The same model, its poses stored as whole numbers of few bits that give the same positions: a
/// run of vertices for each strip. Only the list of key positions is empty.
ModelStorage sample_quantized_model();

/// The one with a rig, in one segment, with a skeleton of two joints, "hip" and "tail".
ModelStorage sample_skeleton_model();

/// A model's arrays, each in a block of memory of its own: where AddressSanitizer sees one step
/// outside.
ModelStorage copy_of(const ModelView& model);

}  // namespace mdk::test
