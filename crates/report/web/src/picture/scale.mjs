// Colours of a field, from 0 to its peak: even steps of lightness, told apart in grey and by the colour-blind.
export const SCALE = ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];
