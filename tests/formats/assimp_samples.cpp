#include "tests/formats/assimp_samples.h"

#include <cmath>
#include <numbers>

namespace mdk::test {
namespace {

std::string source(const std::string& id, const std::string& list, const std::string& accessor) {
  return "<source id=\"" + id + "\">" + list + "<technique_common><accessor source=\"#" + id +
         "-a\" " + accessor + "</accessor></technique_common></source>\n";
}

std::string floats(const std::string& id, int count, const std::string& numbers) {
  return "<float_array id=\"" + id + "-a\" count=\"" + std::to_string(count) + "\">" + numbers +
         "</float_array>";
}

std::string names(const std::string& id, int count, const std::string& words) {
  return "<Name_array id=\"" + id + "-a\" count=\"" + std::to_string(count) + "\">" + words +
         "</Name_array>";
}

const std::string kFloatParam = "<param name=\"X\" type=\"float\"/>";

std::string collada_mesh(const std::string& image) {
  const std::string diffuse =
      image.empty() ? "<color>0.5 0 1 1</color>" : "<texture texture=\"i\" texcoord=\"UV\"/>";
  const std::string images = image.empty() ? ""
                                           : "<library_images><image id=\"i\"><init_from>" + image +
                                                 "</init_from></image></library_images>\n";
  return images +
         "<library_effects><effect id=\"e\"><profile_COMMON><technique sid=\"t\"><lambert>"
         "<diffuse>" +
         diffuse +
         "</diffuse></lambert></technique></profile_COMMON>"
         "</effect></library_effects>\n<library_materials><material id=\"m\" name=\"paint\">"
         "<instance_effect url=\"#e\"/></material></library_materials>\n"
         "<library_geometries><geometry id=\"g\" name=\"bar\"><mesh>\n" +
         source("p", floats("p", 18, "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0 1 2 0"),
                "count=\"6\" stride=\"3\">" + kFloatParam +
                    "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/>") +
         source("u", floats("u", 12, "0 0 1 0 0 0.5 1 0.5 0 1 1 1"),
                "count=\"6\" stride=\"2\"><param name=\"S\" type=\"float\"/>"
                "<param name=\"T\" type=\"float\"/>") +
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n"
         "<polylist count=\"2\" material=\"paint\"><input semantic=\"VERTEX\" source=\"#v\" "
         "offset=\"0\"/><input semantic=\"TEXCOORD\" source=\"#u\" offset=\"0\" set=\"0\"/>"
         "<vcount>4 4</vcount><p>0 1 3 2 2 3 5 4</p></polylist>\n"
         "</mesh></geometry></library_geometries>\n";
}

std::string collada_skin() {
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  return "<library_controllers><controller id=\"c\"><skin source=\"#g\"><bind_shape_matrix>" +
         identity + "</bind_shape_matrix>\n" +
         source("j", names("j", 2, "Hip Knee"),
                "count=\"2\" stride=\"1\"><param name=\"JOINT\" type=\"name\"/>") +
         source("b", floats("b", 32, identity + " 1 0 0 0 0 1 0 -1 0 0 1 0 0 0 0 1"),
                "count=\"2\" stride=\"16\"><param name=\"TRANSFORM\" type=\"float4x4\"/>") +
         source("w", floats("w", 2, "1 0.5"),
                "count=\"2\" stride=\"1\"><param name=\"WEIGHT\" type=\"float\"/>") +
         "<joints><input semantic=\"JOINT\" source=\"#j\"/>"
         "<input semantic=\"INV_BIND_MATRIX\" source=\"#b\"/></joints>\n"
         "<vertex_weights count=\"6\"><input semantic=\"JOINT\" source=\"#j\" offset=\"0\"/>"
         "<input semantic=\"WEIGHT\" source=\"#w\" offset=\"1\"/><vcount>1 1 2 2 1 1</vcount>"
         "<v>0 0 0 0 0 1 1 1 0 1 1 1 1 0 1 0</v></vertex_weights>\n"
         "</skin></controller></library_controllers>\n";
}

std::string collada_animation() {
  return "<library_animations><animation id=\"bend\" name=\"bend\">\n" +
         source("ti", floats("ti", 3, "0 0.5 1"),
                "count=\"3\" stride=\"1\"><param name=\"TIME\" type=\"float\"/>") +
         source("an", floats("an", 3, "0 45 90"),
                "count=\"3\" stride=\"1\"><param name=\"ANGLE\" type=\"float\"/>") +
         source("in", names("in", 3, "LINEAR LINEAR LINEAR"),
                "count=\"3\" stride=\"1\"><param name=\"INTERPOLATION\" type=\"name\"/>") +
         "<sampler id=\"sa\"><input semantic=\"INPUT\" source=\"#ti\"/>"
         "<input semantic=\"OUTPUT\" source=\"#an\"/>"
         "<input semantic=\"INTERPOLATION\" source=\"#in\"/></sampler>"
         "<channel source=\"#sa\" target=\"Knee/turn.ANGLE\"/></animation></library_animations>\n";
}

/// A bone that moves a vertex, which stands at x, y, 0 of the bone.
std::string md5_weight(int number, int joint, double bias, int x, int y) {
  return "\tweight " + std::to_string(number) + " " + std::to_string(joint) + " " +
         std::to_string(bias) + " ( " + std::to_string(x) + " " + std::to_string(y) + " 0 )\n";
}

}  // namespace

std::string bending_collada(const ColladaOptions& options) {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<COLLADA "
         "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n<asset>"
         "<unit name=\"unit\" meter=\"" +
         options.metres + "\"/><up_axis>" + options.up_axis + "</up_axis></asset>\n" +
         collada_mesh(options.image) + collada_skin() + collada_animation() +
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"Hip\" sid=\"Hip\" name=\"Hip\" "
         "type=\"JOINT\"><node id=\"Knee\" sid=\"Knee\" name=\"Knee\" type=\"JOINT\">"
         "<translate sid=\"at\">0 1 0</translate><rotate sid=\"turn\">0 0 1 0</rotate></node>"
         "</node>\n<node id=\"body\" name=\"body\"><instance_controller url=\"#c\"><skeleton>#Hip"
         "</skeleton><bind_material><technique_common><instance_material symbol=\"paint\" "
         "target=\"#m\"/></technique_common></bind_material></instance_controller></node>"
         "</visual_scene></library_visual_scenes>\n"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

std::string bending_md5mesh() {
  std::string text =
      "MD5Version 10\ncommandline \"\"\n\nnumJoints 2\nnumMeshes 1\n\njoints {\n"
      "\t\"Hip\"\t-1 ( 0 0 0 ) ( 0 0 0 )\n\t\"Knee\"\t0 ( 0 1 0 ) ( 0 0 0 )\n}\n\n"
      "mesh {\n\tshader \"paint\"\n\n\tnumverts 6\n";
  const int first_weight[] = {0, 1, 2, 4, 6, 7}, count[] = {1, 1, 2, 2, 1, 1};
  for (int v = 0; v < 6; ++v)
    text += "\tvert " + std::to_string(v) + " ( 0 0 ) " + std::to_string(first_weight[v]) + " " +
            std::to_string(count[v]) + "\n";
  text +=
      "\n\tnumtris 4\n\ttri 0 0 1 3\n\ttri 1 0 3 2\n\ttri 2 2 3 5\n\ttri 3 2 5 4\n\n"
      "\tnumweights 8\n";
  text += md5_weight(0, 0, 1, 0, 0) + md5_weight(1, 0, 1, 1, 0);
  text += md5_weight(2, 0, 0.5, 0, 1) + md5_weight(3, 1, 0.5, 0, 0);
  text += md5_weight(4, 0, 0.5, 1, 1) + md5_weight(5, 1, 0.5, 1, 0);
  text += md5_weight(6, 1, 1, 0, 1) + md5_weight(7, 1, 1, 1, 1);
  return text + "}\n";
}

std::string bending_md5anim() {
  std::string text =
      "MD5Version 10\ncommandline \"\"\n\nnumFrames 3\nnumJoints 2\nframeRate 2\n"
      "numAnimatedComponents 6\n\nhierarchy {\n\t\"Hip\"\t-1 0 0\n\t\"Knee\"\t0 63 0\n}\n\n"
      "bounds {\n";
  for (int frame = 0; frame < 3; ++frame) text += "\t( -2 -2 -2 ) ( 2 2 2 )\n";
  text += "}\n\nbaseframe {\n\t( 0 0 0 ) ( 0 0 0 )\n\t( 0 1 0 ) ( 0 0 0 )\n}\n\n";
  // The fourth number of a rotation is left out, and negative: the third then is, too.
  for (int frame = 0; frame < 3; ++frame)
    text += "frame " + std::to_string(frame) + " {\n\t0 1 0 0 0 " +
            std::to_string(-std::sin(frame * std::numbers::pi / 8)) + "\n}\n\n";
  return text;
}

std::string bending_bvh() {
  return "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0.0 0.0 0.0\n\tCHANNELS 6 Xposition Yposition "
         "Zposition Zrotation Xrotation Yrotation\n\tJOINT Knee\n\t{\n\t\tOFFSET 0.0 2.0 0.0\n"
         "\t\tCHANNELS 3 Zrotation Xrotation Yrotation\n\t\tEnd Site\n\t\t{\n"
         "\t\t\tOFFSET 0.0 1.0 0.0\n\t\t}\n\t}\n}\nMOTION\nFrames: 3\nFrame Time: 0.5\n"
         "0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0\n1.0 0.0 0.0 0.0 0.0 0.0 45.0 0.0 0.0\n"
         "2.0 0.0 0.0 0.0 0.0 0.0 90.0 0.0 0.0\n";
}

std::string moving_x() {
  return "xof 0303txt 0032\n"
         "Frame Mover {\n FrameTransformMatrix {\n  1.0,0.0,0.0,0.0, 0.0,1.0,0.0,0.0, "
         "0.0,0.0,1.0,0.0, 0.0,0.0,0.0,1.0;;\n }\n"
         " Mesh Plate {\n  3;\n  0.0;0.0;0.0;,\n  1.0;0.0;0.0;,\n  0.0;1.0;0.0;;\n  1;\n"
         "  3;0,2,1;;\n }\n}\n"
         "AnimationSet Slide {\n Animation {\n  {Mover}\n  AnimationKey {\n   2;\n   2;\n"
         "   0;3;0.0,0.0,0.0;;,\n   4800;3;2.0,3.0,4.0;;;\n  }\n }\n}\n";
}

std::string turning_fbx(double degrees, int up_axis) {
  const std::string second = "46186158000";
  return "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n"
         "\tFBXVersion: 7300\n}\nGlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n"
         "\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\"," +
         std::to_string(up_axis) +
         "\n"
         "\t\tP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n"
         "\t\tP: \"FrontAxis\", \"int\", \"Integer\", \"\"," +
         std::to_string(3 - up_axis) + "\n\t\tP: \"FrontAxisSign\", \"int\", \"Integer\", \"\"," +
         std::to_string(up_axis == 1 ? 1 : -1) +
         "\n"
         "\t\tP: \"CoordAxis\", \"int\", \"Integer\", \"\",0\n"
         "\t\tP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n"
         "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n\t}\n}\n"
         "Objects:  {\n"
         "\tGeometry: 10, \"Geometry::\", \"Mesh\" {\n\t\tVertices: *9 {\n\t\t\ta: "
         "0,0,0,1,0,0,0,1,0\n\t\t}\n\t\tPolygonVertexIndex: *3 {\n\t\t\ta: 0,1,-3\n\t\t}\n"
         "\t\tGeometryVersion: 124\n\t}\n"
         "\tModel: 20, \"Model::Plate\", \"Mesh\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n"
         "\t\t\tP: \"RotationPivot\", \"Vector3D\", \"Vector\", \"\",1,0,0\n"
         "\t\t\tP: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",0,0,90\n"
         "\t\t\tP: \"RotationActive\", \"bool\", \"\", \"\",1\n"
         "\t\t\tP: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",0,0,0\n\t\t}\n"
         "\t\tShading: T\n\t\tCulling: \"CullingOff\"\n\t}\n"
         "\tAnimationStack: 30, \"AnimStack::Turn\", \"\" {\n\t\tProperties70:  {\n"
         "\t\t\tP: \"LocalStop\", \"KTime\", \"Time\", \"\"," +
         second +
         "\n\t\t}\n\t}\n\tAnimationLayer: 40, \"AnimLayer::Base\", \"\" {\n\t}\n"
         "\tAnimationCurveNode: 50, \"AnimCurveNode::R\", \"\" {\n\t\tProperties70:  {\n"
         "\t\t\tP: \"d|X\", \"Number\", \"\", \"A\",0\n\t\t\tP: \"d|Y\", \"Number\", \"\", "
         "\"A\",0\n"
         "\t\t\tP: \"d|Z\", \"Number\", \"\", \"A\",0\n\t\t}\n\t}\n"
         "\tAnimationCurve: 60, \"AnimCurve::\", \"\" {\n\t\tDefault: 0\n\t\tKeyVer: 4008\n"
         "\t\tKeyTime: *2 {\n\t\t\ta: 0," +
         second + "\n\t\t}\n\t\tKeyValueFloat: *2 {\n\t\t\ta: 0," + std::to_string(degrees) +
         "\n\t\t}\n\t\tKeyAttrFlags: *1 {\n\t\t\ta: 24840\n\t\t}\n\t\tKeyAttrDataFloat: *4 {\n"
         "\t\t\ta: 0,0,0,0\n\t\t}\n\t\tKeyAttrRefCount: *1 {\n\t\t\ta: 2\n\t\t}\n\t}\n}\n"
         "Connections:  {\n\tC: \"OO\",20,0\n\tC: \"OO\",10,20\n\tC: \"OO\",40,30\n"
         "\tC: \"OO\",50,40\n\tC: \"OP\",50,20, \"Lcl Rotation\"\n\tC: \"OP\",60,50, \"d|Z\"\n}\n";
}

}  // namespace mdk::test
