// @ts-check
/**
 * What goes over the socket; `protocol.py` and `tab.py` have the same on the other side.
 *
 * @typedef {{name: string, symbol: string, meaning: string, unit: string, low: number, high: number, root: number}} Parameter
 * @typedef {{do: string, map: string, by?: number, to?: number, share?: number, areas?: string, radius?: number | string}} Edit
 * @typedef {{part: string, [key: string]: any}} MaskPart
 * @typedef {{name?: string, note?: string, on?: boolean, amount?: number, edits?: Edit[], mask?: MaskPart[]}} Layer
 * @typedef {{cutis_look: number, name?: string, layers?: Layer[]}} Look
 * @typedef {{look: Look, ids: string[], revision: number, number: number, undo: boolean, redo: boolean}} State
 * @typedef {{[field: string]: any, op: string}} Op
 * @typedef {[string, number, number]} Span
 * @typedef {{name: string, file: number, width: number, height: number, space: string, origin: string, depth: string, notes: string[], ready: boolean, state: State, spans: Record<string, Span>}} Face
 * @typedef {{stored: number[], lab: number[], ita: number, maps?: Record<string, [number, number | null]>, spectrum?: number[] | null}} Colours
 * @typedef {{at: [number, number], space: string, depth: string, skin: boolean, confidence?: number, original: Colours, edited: Colours | null}} Reading
 * @typedef {{values: number[], colours: string[]}} Track
 * @typedef {{show: string, place: [number, number, number, number], level: number, coarser: number, revision: number, took: number, n: number}} PictureHead
 */
export {};
