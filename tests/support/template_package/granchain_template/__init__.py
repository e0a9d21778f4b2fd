"""A law, an ingredient, a material, a scene, a quantity and a study, installed beside granchain."""
