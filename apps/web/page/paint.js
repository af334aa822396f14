// The model's colours. Pictures come one after another, and the model is drawn without those that have not come.
const MAX_PIXELS = 1 << 27 // of all pictures; a small file can be a large picture
const WHITE = [1, 1, 1]

class Paint {
  // fetchImage: of a picture's number, a promise of its bitmap, or of null.
  constructor(gl, { coats, colours }, fetchImage, changed) {
    Object.assign(this, { gl, coats, isTinted: colours !== null, pictures: new Map(), over: false })
    this.load(fetchImage, changed)
  }

  async load(fetchImage, changed) {
    const numbers = new Set(this.coats.map(({ texture }) => texture).filter(texture => texture !== null))
    let left = MAX_PIXELS, most = this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE)
    for (const number of numbers) {
      const image = await fetchImage(number)
      if (this.over) return
      if (!image || Math.max(image.width, image.height) > most || image.width * image.height > left) continue
      left -= image.width * image.height
      this.pictures.set(number, this.textureOf(image))
      changed()
    }
  }
  textureOf(image) {
    const { gl } = this
    const texture = gl.createTexture()
    gl.activeTexture(gl.TEXTURE1)
    gl.bindTexture(gl.TEXTURE_2D, texture)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.SRGB8_ALPHA8, gl.RGBA, gl.UNSIGNED_BYTE, image)
    gl.generateMipmap(gl.TEXTURE_2D)
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR)
    gl.activeTexture(gl.TEXTURE0)
    image.close()
    return texture
  }
  dispose() {
    this.over = true
    this.pictures.forEach(texture => this.gl.deleteTexture(texture))
  }

  // Calls draw(first, count) for the corners of each coat, with its colour in the program.
  each(program, clay, draw) {
    const { gl } = this
    for (const { first, count, texture, colour } of this.coats) {
      const picture = this.pictures.get(texture)
      gl.activeTexture(gl.TEXTURE1)
      gl.bindTexture(gl.TEXTURE_2D, picture || null)
      gl.activeTexture(gl.TEXTURE0)
      program.set({ picture: 1, textured: Boolean(picture), colour: colour || (picture || this.isTinted ? WHITE : clay) })
      draw(first, count)
    }
  }
}
