// Models: what becomes of their polygons, normals, selections and sequences.
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <map>
#include <set>

#include "framework/one_mesh.h"
#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/scene.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;
using test::kCube, test::kTriangle, test::loadLogged, test::OneMesh, test::tga;

namespace {

/// Normal of a triangle as long as its area.
glm::vec3 areaNormal(const Scene& scene, std::size_t triangle) {
  const auto at = [&](std::size_t k) { return scene.positions[scene.indices[3 * triangle + k]]; };
  return 0.5f * glm::cross(at(1) - at(0), at(2) - at(0));
}

/// A scene `x` of a sequence `m` of so many files `m_0.obj`, `m_1.obj` ...
std::filesystem::path sequenceOf(const test::TemporaryDirectory& directory,
                                 const std::vector<std::string>& frames, const std::string& more = "") {
  for (std::size_t i = 0; i < frames.size(); ++i) directory.write(fmt::format("m_{}.obj", i), frames[i]);
  return directory.write("a.scene",
                         fmt::format("scene \"x\" {{ camera c {{ eye 0 0 9  target 0 0 0 }}\nmesh m {{ file "
                                     "\"m_#.obj\"  sequence 0..{} {} }}\n}}",
                                     frames.size() - 1, more));
}

}  // namespace

TEST_CASE("polygons are cut into triangles that keep their area and their side") {
  const Scene scene = OneMesh("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n").load();
  REQUIRE(scene.triangleCount() == 4);
  float area = 0;
  for (std::size_t t = 0; t < 4; ++t) {
    CHECK(areaNormal(scene, t).z > 0.0f);
    area += areaNormal(scene, t).z;
  }
  CHECK(area == Approx(3.0));  // an L of three unit squares
}

TEST_CASE("indices may be relative and may name texture coordinates and normals") {
  const Scene scene = OneMesh(
                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nvt 1 0\nvt 0 1\nvn 0 0 -2\nf -3/-3/-1 "
                          "-2/-2/-1 -1/-1/-1\n")
                          .load();
  REQUIRE(scene.positions.size() == 3);
  CHECK(scene.texcoords[0] == glm::vec2(0.25f, 0.75f));
  for (const glm::vec3& normal : scene.normals) CHECK(normal == glm::vec3(0, 0, -1));
}

TEST_CASE("a cube without normals gets flat faces, since they meet at 90 degrees") {
  const Scene scene = OneMesh(kCube).load();
  CHECK(scene.triangleCount() == 12);
  CHECK(scene.positions.size() == 24);
  for (std::size_t i = 0; i < 36; ++i)
    CHECK(glm::dot(scene.normals[scene.indices[i]], glm::normalize(areaNormal(scene, i / 3))) ==
          Approx(1.0f));
}

TEST_CASE("a crease of 180 degrees smooths a cube's corners to its diagonals") {
  const Scene scene = OneMesh(kCube, "crease 180 deg").load();
  CHECK(scene.positions.size() == 8);
  // Three right angles meet at each corner, so that angle weighting gives the diagonal whatever way the quads
  // are cut.
  for (std::size_t v = 0; v < 8; ++v) {
    CHECK(glm::dot(scene.normals[v], glm::normalize(scene.positions[v])) == Approx(1.0f));
  }
}

TEST_CASE("a finely cut cylinder is smooth at the default crease and flat at zero") {
  constexpr int kSides = 24;  // neighbours meet at 15 deg
  std::string obj;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * glm::pi<double>() * i / kSides;
    obj += fmt::format("v {0} 0 {1}\nv {0} 1 {1}\n", std::cos(angle), std::sin(angle));
  }
  for (int i = 0; i < kSides; ++i) {
    const int j = (i + 1) % kSides;
    obj += fmt::format("f {} {} {} {}\n", 2 * i + 1, 2 * i + 2, 2 * j + 2, 2 * j + 1);
  }
  const Scene smooth = OneMesh(obj).load();
  CHECK(smooth.positions.size() == 2 * kSides);
  for (std::size_t v = 0; v < smooth.positions.size(); ++v) {
    const glm::vec3 radial = glm::normalize(glm::vec3(smooth.positions[v].x, 0, smooth.positions[v].z));
    CHECK(glm::dot(smooth.normals[v], radial) > 0.999f);
  }
  const Scene flat = OneMesh(obj, "crease 0 deg").load();
  CHECK(flat.positions.size() == 4 * kSides);
}

TEST_CASE("faces that do not share vertices are smoothed where their positions are equal") {
  // Two triangles that meet at 20 deg along a doubled edge.
  const double angle = 20.0 / 180.0 * glm::pi<double>();
  const Scene scene =
      OneMesh(fmt::format("v 0 0 0\nv 0 0 1\nv -1 0 0\nv 0 0 0\nv 0 0 1\nv {} {} 0\nf 1 3 2\nf 4 5 6\n",
                          std::cos(angle), std::sin(angle)))
          .load();
  std::map<std::pair<float, float>, glm::vec3> normals;
  for (std::size_t v = 0; v < scene.positions.size(); ++v) {
    if (scene.positions[v].x != 0) continue;
    const auto [entry, isNew] = normals.emplace(std::pair(scene.positions[v].z, 0.0f), scene.normals[v]);
    if (!isNew) CHECK(glm::length(entry->second - scene.normals[v]) < 1e-6f);
  }
  CHECK(normals.size() == 2);
}

TEST_CASE("normals of the file get unit length, however long or short they are") {
  for (const char* length : {"1e-5", "3", "1e30"}) {
    const Scene scene =
        OneMesh(fmt::format("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 {} 0\nf 1//1 2//1 3//1\n", length)).load();
    CHECK(scene.normals[0] == glm::vec3(0, 1, 0));
  }
}

TEST_CASE("normals of the file hold unless a crease is asked for") {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1\n";
  CHECK(OneMesh(obj).load().normals[0] == glm::vec3(1, 0, 0));
  CHECK(OneMesh(obj, "crease 30 deg").load().normals[0] == glm::vec3(0, 0, 1));
}

TEST_CASE("objects and groups are named by their mesh; equal names are one object") {
  const Scene named =
      OneMesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no box\nf 1 2 3\ng lamp on\nf 1 3 4\no box\nf 1 4 2\n")
          .load();
  REQUIRE(named.objects.size() == 2);
  CHECK(named.objects[0].name == "m/box");
  CHECK(named.objects[1].name == "m/lamp on");
  REQUIRE(named.objects[0].parts.size() == 1);
  CHECK(named.objects[0].parts[0].indexCount == 6);
  CHECK(OneMesh(kTriangle).load().objects.at(0).name == "m");
  CHECK(OneMesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng a\nf 3 2 1\n").load().objects.at(0).name ==
        "m/default");
}

TEST_CASE("every part indexes the vertices of its own object") {
  const Scene scene = OneMesh(
                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no a\nusemtl x\nf 1 2 3\nusemtl y\nf 1 3 4\no "
                          "b\nusemtl x\nf 1 4 2\n")
                          .load();
  for (const Object& object : scene.objects) {
    for (const Part& part : object.parts) {
      for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; ++i) {
        CHECK(scene.indices[i] >= object.firstVertex);
        CHECK(scene.indices[i] < object.firstVertex + object.vertexCount);
      }
    }
  }
}

TEST_CASE("materials of the MTL file are used as given") {
  OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl shiny\nf 1 2 3\nusemtl lamp\nf 3 2 1\n");
  mesh.directory.write("m.mtl",
                       "newmtl shiny\r\nKd 0.1 0.2 0.3\r\nKs 0.4 0.5 0.6\r\nNs 32\r\nillum 2\r\n\r\nnewmtl "
                       "lamp\r\nKd 0.5 0.5 0.5\r\nKe 17 12 4\r\n");
  const Scene scene = mesh.load();
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.materials[0].name == "m/shiny");
  CHECK(scene.materials[0].diffuse == glm::vec3(0.1f, 0.2f, 0.3f));
  CHECK(scene.materials[0].specular == glm::vec3(0.4f, 0.5f, 0.6f));
  CHECK(scene.materials[0].exponent == 32.0f);
  CHECK(scene.materials[1].emission == glm::vec3(17, 12, 4));
  CHECK_FALSE(scene.materials[1].glossy());
  CHECK(SceneTraits::of(scene).areaLights == 1);
}

TEST_CASE("materials are overridden for a mesh, a part and an MTL material, the last one winning") {
  const auto [mesh, diffuse] = GENERATE(table<const char*, const char*>({
      {"", "m/box_1 0.1 0.1; m/box_2 0.2 0.2; m/lamp 0.1 0.1; "},
      {"material red", "m/box_1 1.0 0.0; m/box_2 1.0 0.0; m/lamp 1.0 0.0; "},
      {"use { part box_*  material green }", "m/box_1 0.0 1.0; m/box_2 0.0 1.0; m/lamp 0.1 0.1; "},
      {"use { mtl a  material red }\nuse { part lamp  material green }",
       "m/box_1 1.0 0.0; m/box_2 0.2 0.2; m/lamp 0.0 1.0; "},
      {"use { part box_*  mtl b  material red }", "m/box_1 0.1 0.1; m/box_2 1.0 0.0; m/lamp 0.1 0.1; "},
      {"without { part box_? }", "m/lamp 0.1 0.1; "},
  }));
  OneMesh one(
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no box_1\nusemtl a\nf 1 2 3\no box_2\nusemtl b\nf 1 "
      "3 4\no lamp\nusemtl a\nf 1 4 2\n",
      mesh, "material red { diffuse 1 0 0 }\nmaterial green { diffuse 0 1 0 }");
  one.directory.write("m.mtl", "newmtl a\nKd 0.1 0.1 0.1\nnewmtl b\nKd 0.2 0.2 0.2\n");
  const Scene scene = one.load();
  std::string found;
  for (const Object& object : scene.objects) {
    const Material& material = scene.materials[static_cast<std::size_t>(object.parts.at(0).material)];
    found += fmt::format("{} {:.1f} {:.1f}; ", object.name, material.diffuse.x, material.diffuse.y);
  }
  CHECK(found == diffuse);
}

TEST_CASE("a selection that selects nothing is a finding with the names that the model has") {
  const auto [mesh, more, told] = GENERATE(table<const char*, const char*, Tells>({
      {"use { part tal_box  material red }", "",
       Tells("a.scene:5:12", "m", "part", "tal_box", "mean", "tall_box")},
      {"without { mtl whit }", "", Tells("m", "MTL", "whit", "mean", "white")},
      {"", "light l area { mesh m/lamp  radiance 1 }", Tells("m", "object", "m/lamp")},
      {"", "animate m/tall_bix { translate 1 0 0 }", Tells("m/tall_bix", "mean", "m/tall_box")},
      {"", "animate m { translate 1 0 0 }\nanimate m/tall_box { translate 1 0 0 }",
       Tells("animated", "twice")},
  }));
  OneMesh one("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\no tall_box\nusemtl white\nf 1 2 3\n", mesh,
              std::string("material red { }\n") + more);
  one.directory.write("m.mtl", "newmtl white\nKd 1 1 1\n");
  CHECK_THAT(one.error(), told);
}

TEST_CASE("a mesh is scaled, then turned, then shifted") {
  const Scene scene = OneMesh(kTriangle, "scale 2\nrotate 0 0 1 90 deg\ntranslate 10 0 0").load();
  // (1, 0, 0) -> (2, 0, 0) -> (0, 2, 0) -> (10, 2, 0)
  const glm::dvec4 moved = scene.objects[0].placement * glm::dvec4(1, 0, 0, 1);
  CHECK(moved.x == Approx(10.0));
  CHECK(moved.y == Approx(2.0));
}

TEST_CASE("without a point an animation turns about the centre of what moves") {
  const Scene scene =
      OneMesh("v 4 0 0\nv 6 0 0\nv 4 2 0\nf 1 2 3\n", "", "animate m { rotate 0 0 1 90 deg/s }").load();
  CHECK(scene.objects[0].motion->pivot == glm::dvec3(5, 1, 0));
  const Scene other = OneMesh(kTriangle, "", "animate m { rotate 0 0 1 90 deg/s  about 1 2 3 }").load();
  CHECK(other.objects[0].motion->pivot == glm::dvec3(1, 2, 3));
}

TEST_CASE("quads are cut along their shorter diagonal, and polygons may stand before their vertices") {
  // Corners 1 and 3 of the first quad are the nearer ones; the second starts one corner later.
  using Corners = std::set<std::pair<float, float>>;
  const auto firstTriangle = [](const Scene& scene) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = scene.positions[scene.indices[k]];
      corners.emplace(p.x, p.y);
    }
    return corners;
  };
  CHECK(firstTriangle(OneMesh("v 0 0 0\nv 2 -1 0\nv 1 1 0\nv -1 2 0\nf 1 2 3 4\n").load()) ==
        Corners{{0, 0}, {2, -1}, {1, 1}});
  CHECK(firstTriangle(OneMesh("v 2 -1 0\nv 1 1 0\nv -1 2 0\nv 0 0 0\nf 1 2 3 4\n").load()) ==
        Corners{{2, -1}, {1, 1}, {0, 0}});

  // An L of six corners beside a regular pentagon, each of an object of its own, the L's vertices after its
  // face.
  std::string text =
      "g corner piece\nf 1 2 3 4 5 6\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\no five\n";
  const double fifth = 0.4 * glm::pi<double>();
  for (int k = 0; k < 5; ++k) text += fmt::format("v {} {} 5\n", std::cos(fifth * k), std::sin(fifth * k));
  const Scene scene = OneMesh(text + "f -5 -4 -3 -2 -1\n").load();
  REQUIRE(scene.objects.size() == 2);
  const auto checkObject = [&](std::size_t index, const char* name, std::uint32_t triangles, double area) {
    const Part& part = scene.objects[index].parts[0];
    CHECK(scene.objects[index].name == name);
    CHECK(part.indexCount == 3 * triangles);
    double sum = 0.0;
    for (std::uint32_t t = part.firstIndex / 3; t < part.firstIndex / 3 + triangles; ++t) {
      CHECK(areaNormal(scene, t).z > 0.0f);
      sum += static_cast<double>(areaNormal(scene, t).z);
    }
    CHECK(sum == Approx(area).epsilon(1e-6));
  };
  checkObject(0, "m/corner piece", 4, 3.0);
  checkObject(1, "m/five", 3, 2.5 * std::sin(fifth));  // n/2 sin(2 pi / n), in the unit circle
}

TEST_CASE("FIFOs and devices in place of a scene's files are refused by name, not read") {
  const char* obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  const std::string camera = "camera c { eye 0 0 9  target 0 0 0 }\n";
  for (const bool device : {false, true}) {
    for (const std::string name : {"m.obj", "m.mtl", "p.png", "d.png", "v.vdb", "i.scene"}) {
      CAPTURE(name, device);
      OneMesh mesh(obj, "", "include \"i.scene\"\nmedium s { file \"v.vdb\"  extinction 1 /m  albedo 0.5 }");
      mesh.directory.write("i.scene", "camera second { eye 0 0 9  target 0 0 0 }\n");
      mesh.directory.write("v.vdb", "no volume");
      mesh.directory.write("m.mtl", "newmtl a\nmap_Kd p.png\nmap_d d.png\n");
      for (const char* image : {"p.png", "d.png"})
        writePng(mesh.directory.path() / image, ImageBuffer(8, 8, 3, 0.5f));
      if (name != "v.vdb")  // what comes before the others
        mesh.file = mesh.directory.write(
            "a.scene", "scene \"x\" {\n" + camera + "mesh m { file \"m.obj\" }\ninclude \"i.scene\"\n}\n");
      const auto path = mesh.directory.path() / name;
      std::filesystem::remove(path);
      if (device) {
        std::filesystem::create_symlink("/dev/zero", path);
      } else {
        REQUIRE(mkfifo(path.c_str(), 0600) == 0);
      }
      constexpr unsigned kSeconds = 30;
      alarm(kSeconds);  // a call that waits for ever ends the program, and so the test
      CHECK_THAT(mesh.error(), Tells(name, device ? "is a device" : "is a FIFO"));
      alarm(0);
    }
  }
}

TEST_CASE("a sequence is read frame by frame with one set of faces, and a frame that does not fit is named") {
  const test::TemporaryDirectory directory;
  std::vector<std::string> frames;
  for (int i = 0; i < 3; ++i) frames.push_back(fmt::format("v 0 0 {0}\nv 1 0 {0}\nv 0 1 {0}\nf 1 2 3\n", i));
  const auto file = sequenceOf(directory, frames, "rate 10  loop off");
  const Scene scene = loadScene(file);
  REQUIRE(scene.objects.at(0).sequence.has_value());
  const VertexSequence& sequence = *scene.objects[0].sequence;
  CHECK(sequence.framesPerSecond == 10.0);
  CHECK_FALSE(sequence.loop);
  REQUIRE(sequence.positions.size() == 3);
  CHECK(sequence.positions[2].at(0).z == 2.0f);
  CHECK(sequence.normals[2].at(0) == glm::vec3(0, 0, 1));
  CHECK(SceneTraits::of(scene).movingGeometry);

  const auto [wrong, told] = GENERATE(table<const char*, Tells>({
      {"v 0 0 1\nv 1 0 1\nv 0 1 1\nv 0 0 0\nf 1 2 3\n", Tells("m_2.obj", 4, "positions", 3)},
      {"v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 3 2\n", Tells("m_2.obj", "faces")},
      {"v 0 0 1\nv 1 nan 1\nv 0 1 1\nf 1 2 3\n", Tells("m_2.obj:2", "finite")},
      {"", Tells("m_2.obj")},
  }));
  directory.write("m_2.obj", wrong);
  CHECK_THROWS_MATCHES(loadScene(file), Error, told);
  std::filesystem::remove(directory.path() / "m_2.obj");
  CHECK_THROWS_MATCHES(loadScene(file), Error, Tells("m_2.obj"));
}

TEST_CASE("normals of a deforming mesh follow each frame") {
  const test::TemporaryDirectory directory;
  const Scene scene = loadScene(sequenceOf(
      directory, {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "v 0 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"}));
  CHECK(scene.objects.at(0).sequence->normals.at(0).at(0) == glm::vec3(0, 0, 1));
  CHECK(scene.objects.at(0).sequence->normals.at(1).at(0) == glm::vec3(1, 0, 0));
}

TEST_CASE("the hash changes with the text and every file that the scene uses, and no other") {
  const auto hashOf = [](const std::string& changed) {
    const test::TemporaryDirectory directory;
    const auto content = [&](const std::string& name, const std::string& text) {
      directory.write(name, text + (changed == name ? "\n# changed\n" : ""));
    };
    content("m.obj", std::string("mtllib m.mtl\nusemtl a\n") + kTriangle);
    content("m.mtl", "newmtl a\nmap_Kd p.tga\n");
    directory.write("p.tga", tga(1, 1, 3, {1, 2, static_cast<unsigned char>(changed == "p.tga" ? 4 : 3)}));
    content("light.part", "environment { radiance 1 }\n");
    directory.write("unused.obj", changed == "unused.obj" ? "x" : "y");
    content("a.scene",
            "scene \"x\" { camera c { eye 0 0 9  target 0 0 0 }\nmesh m { file \"m.obj\" }\ninclude "
            "\"light.part\"\n}");
    return loadScene(directory.path() / "a.scene").hash;
  };
  const ContentHash plain = hashOf("");
  CHECK(hashOf("") == plain);  // in another directory
  CHECK(hashOf("unused.obj") == plain);
  for (const char* name : {"m.obj", "m.mtl", "p.tga", "light.part", "a.scene"}) {
    INFO(name);
    CHECK_FALSE(hashOf(name) == plain);
  }
}

TEST_CASE("loading the same scene twice gives the same vertices in the same order") {
  const OneMesh mesh(kCube, "crease 100 deg");
  const Scene a = mesh.load(), b = mesh.load();
  CHECK(a.positions == b.positions);
  CHECK(a.normals == b.normals);
  CHECK(a.indices == b.indices);
}
