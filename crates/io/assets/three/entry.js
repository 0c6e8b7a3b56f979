// What the page needs of three.js, and no more.
export {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, HemisphereLight, InstancedMesh,
  LineBasicMaterial, LineSegments, Matrix4, MeshLambertMaterial, PerspectiveCamera, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from "three";
