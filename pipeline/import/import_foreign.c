/* Reads OBJ, STL, OFF and glTF with assimp in a sandboxed child process. assimp's output is not
 * trusted either: every index is checked. */
#include "pipeline/import/import_foreign.h"

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/shared_memory.h"
#include "geometry/srgb.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/import_limits.h"
#include "pipeline/import/import_scene.h"
#include "pipeline/import/import_texture.h"
#include "pipeline/import/mesh_file.h"
#include "pipeline/import/sandbox.h"

/* MAXLEN is defined by assimp: the size of a name. */
enum { NODE_DEPTH_MAX = 256 };

static const struct hash no_key;

/* In shared memory. The child reads path and format, and fills in report; the mesh goes to
 * result_fd. */
struct job {
	/* ends with the format's own extension, by which assimp chooses its reader */
	char path[PATH_MAX];
	struct import_foreign_format format;
	int result_fd; /* receives the mesh as a mesh file */
	struct import_report report;
};

/* ---- in the child: converting an assimp scene into a mesh */

struct builder {
	const struct aiScene *scene;
	struct job *job;
	struct diagnostics *diagnostics;
	struct mesh mesh;
	uint64_t vertices, triangles; /* sums over all instances, counted in the first pass */
	uint64_t skipped;             /* points and lines that were skipped */
	bool has_colours, has_textures;
	bool has_bytes; /* colours of vertices are 0..255, as MeshLab writes in OFF; else 0..1 */
};

/* Converts a colour to a byte; linear ones with the sRGB transfer function, IEC 61966-2-1. */
static uint8_t colour_byte(float value, bool is_linear)
{
	if (!(value > 0))
		return 0;
	if (value >= 1)
		return 255;
	if (is_linear)
		value = srgb_of_light(value);
	return (uint8_t)(value * 255 + 0.5f);
}

/* Gets the file name of a material's picture, and which of the texture coordinates it lies by.
 * Returns false if it has none. */
static bool picture_of(const struct aiMaterial *material, char name[MAXLEN], unsigned *channel)
{
	static const enum aiTextureType types[] = { aiTextureType_BASE_COLOR,
						    aiTextureType_DIFFUSE };
	struct aiString path;

	*channel = 0;
	for (size_t i = 0; i < ARRAY_COUNT(types); i++)
		if (aiGetMaterialTexture(material, types[i], 0, &path, NULL, channel, NULL, NULL,
					 NULL, NULL) == aiReturn_SUCCESS) {
			snprintf(name, MAXLEN, "%s", path.data);
			return true;
		}
	return false;
}

/* Returns the texture coordinates of the mesh's picture, or NULL. */
static const struct aiVector3D *coordinates_of(const struct aiMesh *mesh,
					       const struct aiMaterial *material)
{
	char name[MAXLEN];
	unsigned channel;

	return picture_of(material, name, &channel) && channel < AI_MAX_NUMBER_OF_TEXTURECOORDS
		       ? mesh->mTextureCoords[channel]
		       : NULL;
}

/* Gets the colour of a material's body. assimp gives that of glTF twice; where the material is
 * specular and glossy (KHR_materials_pbrSpecularGlossiness), the first is only a default. */
static bool body_colour_of(const struct aiMaterial *material, struct aiColor4D *colour)
{
	float glossiness;
	const bool is_glossy = aiGetMaterialFloat(material, AI_MATKEY_GLOSSINESS_FACTOR,
						  &glossiness) == aiReturn_SUCCESS;

	return (!is_glossy &&
		aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, colour) == aiReturn_SUCCESS) ||
	       aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS;
}

/* Gets a material's plain colour. Returns false if it is only a default (that of assimp, or white,
 * that of the formats). */
static bool plain_colour_of(const struct aiMaterial *material, struct import_foreign_format format,
			    uint8_t rgb[3])
{
	struct aiColor4D colour;
	struct aiString name;

	memset(rgb, 255, 3);
	if (!format.has_materials)
		return false;
	if (aiGetMaterialString(material, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS &&
	    strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0)
		return false;
	if (!body_colour_of(material, &colour))
		return false;
	rgb[0] = colour_byte(colour.r, format.is_linear);
	rgb[1] = colour_byte(colour.g, format.is_linear);
	rgb[2] = colour_byte(colour.b, format.is_linear);
	return rgb[0] != 255 || rgb[1] != 255 || rgb[2] != 255;
}

/* Gets what glTF multiplies a picture, and the colours of vertices, with. Returns false if that
 * changes nothing. In other formats a colour beside a picture is a shade that programs leave there.
 */
static bool factor_of(const struct aiMaterial *material, struct import_foreign_format format,
		      float factor[3])
{
	struct aiColor4D colour;

	for (int k = 0; k < 3; k++)
		factor[k] = 1;
	if (!format.is_linear || !body_colour_of(material, &colour))
		return false;
	factor[0] = colour.r;
	factor[1] = colour.g;
	factor[2] = colour.b;
	return factor[0] != 1 || factor[1] != 1 || factor[2] != 1;
}

/* How KHR_texture_transform of glTF moves texture coordinates. */
struct uv_move {
	bool is_there; /* else nothing moves, and all bits stay */
	float offset[2], cosine, sine, scale[2];
};

/* assimp gives it about the middle of the picture, with v from the bottom and turned backwards. */
static struct uv_move uv_move_of(const struct aiMaterial *material)
{
	struct uv_move move = { 0 };
	struct aiUVTransform about_middle;
	float c, s, x, y;

	if (aiGetMaterialUVTransform(material, AI_MATKEY_UVTRANSFORM(aiTextureType_DIFFUSE, 0),
				     &about_middle) != aiReturn_SUCCESS)
		return move;
	c = cosf(-about_middle.mRotation);
	s = sinf(-about_middle.mRotation);
	x = about_middle.mScaling.x;
	y = about_middle.mScaling.y;
	move = (struct uv_move){ true,
				 { about_middle.mTranslation.x - x * (1 - c + s) / 2,
				   1 - y + y * (s + c - 1) / 2 - about_middle.mTranslation.y },
				 c,
				 s,
				 { x, y } };
	return move;
}

/* Moves coordinates with v from the bottom. */
static void move_uv(float out[2], const struct uv_move *move, const struct aiVector3D *from)
{
	const float u = move->scale[0] * from->x, v = move->scale[1] * (1 - from->y);

	out[0] = from->x;
	out[1] = from->y;
	if (!move->is_there)
		return;
	out[0] = move->offset[0] + move->cosine * u + move->sine * v;
	out[1] = 1 - (move->offset[1] - move->sine * u + move->cosine * v);
}

/* Those of glTF are light, which may be brighter than 1. Shares may be a little above 1 where a
 * program has rounded them; bytes are whole numbers. */
static bool has_bytes(const struct aiMesh *mesh, struct import_foreign_format format)
{
	const struct aiColor4D *colours = format.is_linear ? NULL : mesh->mColors[0];
	float most = 0;

	for (uint32_t i = 0; colours && i < mesh->mNumVertices; i++)
		most = fmaxf(most, fmaxf(colours[i].r, fmaxf(colours[i].g, colours[i].b)));
	return most >= 2;
}

static int count_mesh(struct builder *builder, uint32_t index)
{
	const struct aiMesh *mesh;
	const struct aiMaterial *material;
	uint8_t rgb[3];

	if (index >= builder->scene->mNumMeshes)
		return -EBADMSG;
	mesh = builder->scene->mMeshes[index];
	if (mesh->mMaterialIndex >= builder->scene->mNumMaterials)
		return -EBADMSG;
	material = builder->scene->mMaterials[mesh->mMaterialIndex];
	builder->vertices += mesh->mNumVertices;
	builder->triangles += mesh->mNumFaces;
	if (builder->vertices >= UINT32_MAX || builder->triangles >= UINT32_MAX)
		return -EFBIG;
	builder->has_colours |=
		mesh->mColors[0] || plain_colour_of(material, builder->job->format, rgb);
	builder->has_textures |= coordinates_of(mesh, material) != NULL;
	builder->has_bytes |= has_bytes(mesh, builder->job->format);
	return 0;
}

/* Finds an embedded picture: "*3" is the fourth one in the scan. NULL: name is that of a file. */
static const struct aiTexture *embedded_texture(const struct aiScene *scene, const char *name)
{
	char *end;
	unsigned long index;

	for (uint32_t i = 0; i < scene->mNumTextures; i++)
		if (name[0] && strcmp(scene->mTextures[i]->mFilename.data, name) == 0)
			return scene->mTextures[i];
	if (name[0] != '*')
		return NULL;
	index = strtoul(name + 1, &end, 10);
	return *end == '\0' && end != name + 1 && index < scene->mNumTextures
		       ? scene->mTextures[index]
		       : NULL;
}

static int load_embedded(struct builder *builder, const struct aiTexture *picture, const char *name,
			 const uint8_t plain[3], struct mesh_texture *out)
{
	const struct bytes file = { (const uint8_t *)picture->pcData, picture->mWidth };

	if (picture->mHeight == 0)
		return import_texture_bytes(out, builder->job->path, name, file, plain,
					    &builder->job->report);
	if (picture->mWidth == 0 || picture->mWidth > 16384 || picture->mHeight > 16384)
		return import_texture_plain(out, plain);
	out->rgb = malloc((size_t)picture->mWidth * picture->mHeight * 3);
	if (!out->rgb)
		return -ENOMEM;
	out->width = picture->mWidth;
	out->height = picture->mHeight;
	for (size_t i = 0; i < (size_t)out->width * out->height; i++) {
		out->rgb[3 * i] = picture->pcData[i].r;
		out->rgb[3 * i + 1] = picture->pcData[i].g;
		out->rgb[3 * i + 2] = picture->pcData[i].b;
	}
	builder->job->report.textures++;
	return 0;
}

static int load_texture(struct builder *builder, const struct aiMaterial *material,
			struct mesh_texture *out)
{
	struct import_files files = { .scan_path = builder->job->path, .in_sandbox = true };
	const struct aiTexture *embedded;
	char name[MAXLEN];
	unsigned channel;
	uint8_t plain[3];

	plain_colour_of(material, builder->job->format, plain);
	if (!picture_of(material, name, &channel))
		return import_texture_plain(out, plain);
	embedded = embedded_texture(builder->scene, name);
	if (embedded)
		return load_embedded(builder, embedded, name, plain, out);
	return import_texture(out, &files, name, plain, &builder->job->report);
}

/* Multiplies the light of a picture. */
static void tint(struct mesh_texture *picture, const float factor[3])
{
	const size_t pixels = (size_t)picture->width * picture->height;
	uint8_t tinted[3][256];

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 256; i++)
			tinted[k][i] = colour_byte(factor[k] * srgb_to_light((float)i / 255), true);
	for (size_t i = 0; i < 3 * pixels; i++)
		picture->rgb[i] = tinted[i % 3][picture->rgb[i]];
}

static int load_tinted(struct builder *builder, const struct aiMaterial *material,
		       struct mesh_texture *out)
{
	const uint32_t pictures = builder->job->report.textures;
	float factor[3];
	int rc = load_texture(builder, material, out);

	/* what stands for a picture has the colour */
	if (rc == 0 && builder->job->report.textures > pictures &&
	    factor_of(material, builder->job->format, factor))
		tint(out, factor);
	return rc;
}

/* Loads one texture per material; a plain colour becomes a texture of one pixel. */
static int load_textures(struct builder *builder)
{
	uint32_t count = builder->scene->mNumMaterials;
	struct mesh *mesh = &builder->mesh;
	int rc = 0;

	if (count > MESH_TEXTURES_MAX)
		return -EFBIG;
	mesh->textures = calloc(count, sizeof(*mesh->textures));
	if (!mesh->textures)
		return -ENOMEM;
	mesh->texture_count = count;
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = load_tinted(builder, builder->scene->mMaterials[i], &mesh->textures[i]);
	return rc;
}

static int allocate(struct builder *builder)
{
	struct mesh *mesh = &builder->mesh;

	mesh->positions = malloc((builder->vertices + 1) * sizeof(*mesh->positions));
	mesh->triangles = malloc((builder->triangles + 1) * sizeof(*mesh->triangles));
	if (!mesh->positions || !mesh->triangles)
		return -ENOMEM;
	if (builder->has_textures) {
		mesh->uvs = calloc(builder->vertices + 1, sizeof(*mesh->uvs));
		mesh->materials = malloc((builder->triangles + 1) * sizeof(*mesh->materials));
		return mesh->uvs && mesh->materials ? load_textures(builder) : -ENOMEM;
	}
	if (builder->has_colours) {
		mesh->colours = malloc((builder->vertices + 1) * sizeof(*mesh->colours));
		return mesh->colours ? 0 : -ENOMEM;
	}
	return 0;
}

static void add_vertices(struct builder *builder, const struct aiMesh *from,
			 const struct aiMatrix4x4 *place)
{
	struct mesh *mesh = &builder->mesh;
	const struct aiMaterial *material = builder->scene->mMaterials[from->mMaterialIndex];
	const struct aiVector3D *coordinates = coordinates_of(from, material);
	const struct uv_move move = uv_move_of(material);
	bool is_linear = builder->job->format.is_linear;
	float factor[3];
	uint8_t plain[3];

	plain_colour_of(material, builder->job->format, plain);
	factor_of(material, builder->job->format, factor);
	for (int k = 0; k < 3 && builder->has_bytes; k++)
		factor[k] /= 255;
	for (uint32_t i = 0; i < from->mNumVertices; i++) {
		uint32_t at = mesh->vertex_count++;
		struct aiVector3D v = from->mVertices[i];

		aiTransformVecByMatrix4(&v, place);
		memcpy(mesh->positions[at], (float[3]){ v.x, v.y, v.z }, 12);
		if (mesh->uvs && coordinates)
			move_uv(mesh->uvs[at], &move, &coordinates[i]);
		if (!mesh->colours)
			continue;
		memcpy(mesh->colours[at], plain, 3);
		mesh->colours[at][3] = 255;
		if (from->mColors[0]) {
			mesh->colours[at][0] =
				colour_byte(factor[0] * from->mColors[0][i].r, is_linear);
			mesh->colours[at][1] =
				colour_byte(factor[1] * from->mColors[0][i].g, is_linear);
			mesh->colours[at][2] =
				colour_byte(factor[2] * from->mColors[0][i].b, is_linear);
		}
	}
}

/* Adds one instance. A mirrored instance would turn its faces inside out, so their corners are
 * reversed. */
static int add_mesh(struct builder *builder, uint32_t index, const struct aiMatrix4x4 *place)
{
	const struct aiMesh *from = builder->scene->mMeshes[index];
	struct mesh *mesh = &builder->mesh;
	uint32_t base = mesh->vertex_count;
	bool mirrored = aiMatrix4Determinant(place) < 0;

	add_vertices(builder, from, place);
	for (uint32_t i = 0; i < from->mNumFaces; i++) {
		const struct aiFace *face = &from->mFaces[i];
		uint32_t *triangle = mesh->triangles[mesh->triangle_count];

		if (face->mNumIndices != 3) {
			builder->skipped++;
			continue;
		}
		for (int k = 0; k < 3; k++) {
			uint32_t corner = face->mIndices[mirrored ? 2 - k : k];

			if (corner >= from->mNumVertices)
				return diagnostics_add(
					builder->diagnostics, -EBADMSG, builder->job->path, 0,
					"face %u of its part %u names vertex %u, but "
					"the part has %u; correct or remove it",
					i, index, corner, from->mNumVertices);
			triangle[k] = base + corner;
		}
		if (mesh->materials)
			mesh->materials[mesh->triangle_count] = (uint16_t)from->mMaterialIndex;
		mesh->triangle_count++;
	}
	return 0;
}

/* Walks the nodes. It runs twice: the first pass counts, the second builds. */
static int walk(struct builder *builder, const struct aiNode *node,
		const struct aiMatrix4x4 *parent, int depth, bool build)
{
	struct aiMatrix4x4 place = *parent;
	int rc = 0;

	if (depth > NODE_DEPTH_MAX)
		return diagnostics_add(builder->diagnostics, -EBADMSG, builder->job->path, 0,
				       "its nodes are nested over %d deep", NODE_DEPTH_MAX);
	aiMultiplyMatrix4(&place, &node->mTransformation);
	for (uint32_t i = 0; i < node->mNumMeshes && rc == 0; i++)
		rc = build ? add_mesh(builder, node->mMeshes[i], &place)
			   : count_mesh(builder, node->mMeshes[i]);
	for (uint32_t i = 0; i < node->mNumChildren && rc == 0; i++)
		rc = walk(builder, node->mChildren[i], &place, depth + 1, build);
	return rc;
}

static int build(struct builder *builder)
{
	const char *path = builder->job->path;
	struct aiMatrix4x4 identity;
	int rc;

	aiIdentityMatrix4(&identity);
	rc = walk(builder, builder->scene->mRootNode, &identity, 0, false);
	if (rc == 0)
		rc = allocate(builder);
	if (rc == 0)
		rc = walk(builder, builder->scene->mRootNode, &identity, 0, true);
	if (rc == -ENOMEM)
		return diagnostics_add(builder->diagnostics, rc, path, 0,
				       "too large for this machine's memory");
	if (rc == -EFBIG)
		return diagnostics_add(
			builder->diagnostics, rc, path, 0,
			"too many triangles or materials; split it into several files");
	if (rc < 0)
		return diagnostics_add(builder->diagnostics, rc, path, 0,
				       "it contradicts itself; export it again");
	if (builder->mesh.triangle_count == 0)
		return diagnostics_add(builder->diagnostics, -EBADMSG, path, 0,
				       "it holds no faces%s; export a surface",
				       builder->skipped ? ", only points or lines" : "");
	if (builder->skipped)
		diagnostics_add(&builder->job->report.warning, 0, path, 0,
				"%llu points or lines in it were left out",
				(unsigned long long)builder->skipped);
	builder->job->report.had_colours = builder->has_colours && !builder->has_textures;
	return 0;
}

static int read_scene(void *shared, struct diagnostics *diagnostics)
{
	struct job *job = shared;
	struct builder builder = { .job = job, .diagnostics = diagnostics };
	int rc;

	builder.scene =
		import_scene(job->path, job->report.format, &job->report.warning, diagnostics);
	if (!builder.scene)
		return -EBADMSG;
	rc = build(&builder);
	if (rc == 0)
		rc = mesh_file_write(job->result_fd, &builder.mesh, no_key);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, job->path, 0, "%s", strerror(-rc));
	return rc; /* the process ends now and releases everything */
}

/* ---- in the parent */

/* What the child may open: the scan, and files below its folder. The shared job is not consulted
 * for this, because foreign code may have changed it. */
struct parent {
	const char *path; /* borrowed; as given */
	char seen_path[PATH_MAX];
	int scan_fd, folder_fd, result_fd;
	struct import_files_failure failure;
	const struct import_options *options; /* borrowed */
	uint64_t file_bytes;                  /* of the scan and of what it named so far */
	struct import_files_counted counted;
};

/* By default about 200 times what intact files of that size take on an idle machine. Of the address
 * space, the child begins with that of its parent, where scans that were read before may lie. */
static struct sandbox_limits limits_of(const struct parent *parent)
{
	const struct import_options *options = parent->options;

	return (struct sandbox_limits){
		.timeout_s = options->timeout_s ? options->timeout_s
						: (uint32_t)(6 + (parent->file_bytes >> 18)),
		.memory_bytes =
			sandbox_memory_bytes(import_memory_bytes(options, parent->file_bytes)),
	};
}

/* A glTF of a few kB may name hundreds of MB, and an OBJ many pictures. */
static int open_for_child(void *data, const char *name, struct sandbox_limits *limits)
{
	struct parent *parent = data;
	int fd;

	if (strcmp(name, parent->seen_path) != 0) {
		fd = import_files_open_at(parent->folder_fd, name);
		if (fd >= 0) {
			parent->file_bytes += import_files_count(&parent->counted, fd);
			*limits = limits_of(parent);
		}
	} else {
		fd = fcntl(parent->scan_fd, F_DUPFD_CLOEXEC, 0);
		fd = fd < 0 ? -errno : fd;
	}
	import_files_note(&parent->failure, fd, name);
	return fd;
}

/* Copies the path, and appends the format's extension if it has another one or none. */
static int make_seen_path(char seen[PATH_MAX], const char *path, const char *extension)
{
	bool has = import_has_extension(path, extension);

	return snprintf(seen, PATH_MAX, "%s%s", path, has ? "" : extension) < PATH_MAX
		       ? 0
		       : -ENAMETOOLONG;
}

static int open_scan(const char *path)
{
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	struct stat status;

	if (fd < 0)
		return -errno;
	if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode))
		return fd;
	close(fd);
	return -EINVAL;
}

static int parent_init(struct parent *parent, const char *path, const char *extension,
		       const struct import_options *options, uint64_t file_bytes)
{
	int rc;

	*parent = (struct parent){ .path = path,
				   .scan_fd = -1,
				   .folder_fd = -1,
				   .result_fd = -1,
				   .options = options,
				   .file_bytes = file_bytes };
	rc = make_seen_path(parent->seen_path, path, extension);
	if (rc == 0)
		rc = parent->scan_fd = open_scan(path);
	if (rc >= 0)
		rc = parent->folder_fd = import_files_open_folder(path);
	if (rc < 0)
		return rc;
	parent->result_fd = memfd_create("gopura-import", MFD_CLOEXEC);
	return parent->result_fd < 0 ? -errno : 0;
}

static void parent_finish(struct parent *parent)
{
	const int fds[] = { parent->scan_fd, parent->folder_fd, parent->result_fd };

	for (size_t i = 0; i < ARRAY_COUNT(fds); i++)
		if (fds[i] >= 0)
			close(fds[i]);
}

static int run_job(struct mesh *out, struct job *job, struct parent *parent,
		   struct diagnostics *diagnostics)
{
	const struct sandbox_options options = {
		.limits = limits_of(parent),
		.result_fd = parent->result_fd,
		.open = open_for_child,
		.open_data = parent,
	};
	int rc = sandbox_run(read_scene, job, &options, parent->path, diagnostics);

	rc = import_files_judge(&parent->failure, rc, parent->path, diagnostics);
	if (rc < 0)
		return rc;
	if (lseek(parent->result_fd, 0, SEEK_SET) < 0)
		return diagnostics_add(diagnostics, -errno, parent->path, 0, "%s", strerror(errno));
	rc = mesh_file_read(out, no_key, parent->result_fd);
	if (rc == -EBADMSG || rc == -ESTALE)
		return diagnostics_add(diagnostics, rc, parent->path, 0,
				       "its reader returned an invalid mesh; export it again");
	return rc < 0 ? diagnostics_add(diagnostics, rc, parent->path, 0, "%s", import_lack(rc))
		      : 0;
}

/* Copies only what the child fills in. The child is not trusted: a string may lack its end. */
static void take_report(struct import_report *report, const struct import_report *told)
{
	/* the byte may have any value */
	report->had_colours = *(const uint8_t *)&told->had_colours != 0;
	report->textures = told->textures;
	if (told->warning.first.text[0])
		diagnostics_add(&report->warning, 0, NULL, 0, "%.*s", DIAGNOSTIC_BYTES - 1,
				told->warning.first.text);
}

int import_foreign(struct mesh *out, const char *path, struct import_foreign_format format,
		   const struct import_options *options, struct import_report *report,
		   struct diagnostics *diagnostics)
{
	struct job *job = shared_memory_create(sizeof(*job));
	struct parent parent;
	int rc = parent_init(&parent, path, format.extension, options, report->file_bytes);

	if (!job && rc == 0)
		rc = -ENOMEM;
	if (rc < 0) {
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc));
	} else {
		memcpy(job->path, parent.seen_path, sizeof(job->path));
		job->format = format;
		job->report = *report;
		job->result_fd = parent.result_fd;
		rc = run_job(out, job, &parent, diagnostics);
		take_report(report, &job->report);
	}
	parent_finish(&parent);
	shared_memory_destroy(job, sizeof(*job));
	return rc;
}
